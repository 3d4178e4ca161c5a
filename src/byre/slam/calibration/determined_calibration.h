#pragma once

#include "byre/geometry/calibration_change.h"

namespace byre {

inline constexpr double kImplausibleSigmas = 5.0;  // sigmas of the prior, least change that is implausible

// Standard errors of a calibration before refinement, in the parameters' sigmas: equal factors, or those of nominal
// numbers, as drivers publish for cameras that were never calibrated (6 % of the focal length, 15 px, 0.15 of k1 and
// k2).
CalibrationVector calibrated_sigmas(double factor);
CalibrationVector nominal_sigmas();

// The given calibration plus the expected change along directions that are known twice as well as by the prior. Other
// directions stay as given. Nothing changes if noise explains a change of that size. information and expected:
// posterior in the parameters' sigmas, with a prior of these sigmas. Keyframes, observations and shift are left to the
// caller.
RefinedCalibration determined_calibration(const Calibration& given, const CalibrationMatrix& information,
                                          const CalibrationVector& expected, const CalibrationVector& prior_sigmas);

// Resets a change that exceeds five prior sigmas in any parameter, or is part of one that does, or leaves no
// calibration to rectify by: the measurements do not fit the model, and no part of the change is reliable. expected:
// the full change, also along directions that are hardly better known than by the prior.
void reject_implausible(RefinedCalibration& refined, const CalibrationVector& expected, const Calibration& given,
                        const CalibrationVector& prior_sigmas);

}  // namespace byre
