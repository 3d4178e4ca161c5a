#pragma once

#include "byre/geometry/calibration_change.h"

namespace byre {

// The calibration given, changed by what is known of it (information and expected change, in the parameters' sigmas,
// with a prior of so many sigmas in all directions). Only along directions that are known twice as well as before;
// along the others it stays. It stays as given altogether when noise would make a change of that size as well.
// Keyframes, observations and shift are left to the caller.
RefinedCalibration determined_calibration(const Calibration& given, const CalibrationMatrix& information,
                                          const CalibrationVector& expected, double prior_sigmas);

// Takes back a change that is larger in any parameter than calibrations err, five times the prior, or is a part of one
// that is: what was seen does not fit the model, and where a prior gives way so far, the rest of the change is made up.
// expected: all of it, also along directions that are hardly known better than before.
void refuse_implausible(RefinedCalibration& refined, const CalibrationVector& expected, const Calibration& given,
                        double prior_sigmas);

}  // namespace byre
