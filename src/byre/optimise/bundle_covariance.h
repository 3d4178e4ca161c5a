#pragma once

#include "byre/optimise/bundle_adjustment.h"

#include <optional>

namespace byre {

// The covariance of one pose with all other moving poses and points free and the fixed ones true: the inverse of the
// robustly weighted normal matrix, with points and then poses eliminated (Schur complement). Of delta in
// exp_pose(delta) * camera_from_world. Empty where the observations do not determine the pose. Dense over the moving
// poses: cubic in their number, meant for windows.
std::optional<Matrix6> marginal_covariance(const BundleProblem& solved, int pose, double huber_width);

}  // namespace byre
