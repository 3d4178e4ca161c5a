#pragma once

#include "byre/optimise/bundle_adjustment.h"

#include <optional>

namespace byre {

// What the observations tell of the calibration that is sought, with poses and points free: the information of
// BundleCalibration together with what is left of the observations' once points and then poses are eliminated from the
// robustly weighted normal matrix. solved: the problem with poses and points at the solution. Dense over the moving
// poses: cubic in their number. A pose that nothing determines is taken as known to 10 m and 10 radians, a point to
// 10,000 times as far as across. Empty where that does not help either.
std::optional<CalibrationMatrix> calibration_information(const BundleProblem& solved, double huber_width);

}  // namespace byre
