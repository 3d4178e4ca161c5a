#pragma once

#include "byre/optimise/bundle_adjustment.h"

#include <optional>

namespace byre {

// Information on the estimated calibration, marginalised over poses and points: the prior of BundleCalibration plus the
// Schur complement of the robustly weighted normal matrix over points, then poses. solved: the problem with poses and
// points at the solution. Dense over the moving poses: cubic in their number. Weak priors of 10 m and 10 radians per
// pose, and of 10,000 times the lateral sigma per point, keep it regular. Empty if it is still singular.
std::optional<CalibrationMatrix> calibration_information(const BundleProblem& solved, double huber_width);

}  // namespace byre
