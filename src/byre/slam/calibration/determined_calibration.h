#pragma once

#include "byre/geometry/calibration_change.h"

namespace byre {

// The given calibration plus the expected change along directions that are known twice as well as by the prior. Other
// directions stay as given. Nothing changes if noise explains a change of that size. information and expected:
// posterior in the parameters' sigmas, with a prior of prior_sigmas in all directions. Keyframes, observations and
// shift are left to the caller.
RefinedCalibration determined_calibration(const Calibration& given, const CalibrationMatrix& information,
                                          const CalibrationVector& expected, double prior_sigmas);

// Resets a change that exceeds five prior sigmas in any parameter, or is part of one that does, or leaves no
// calibration to rectify by: the measurements do not fit the model, and no part of the change is reliable. expected:
// the full change, also along directions that are hardly better known than by the prior.
void reject_implausible(RefinedCalibration& refined, const CalibrationVector& expected, const Calibration& given,
                        double prior_sigmas);

}  // namespace byre
