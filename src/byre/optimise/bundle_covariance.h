#pragma once

#include "byre/optimise/bundle_adjustment.h"

#include <optional>

namespace byre {

// Holds the scale of a bundle that nothing else tells the scale of: how far a pose's camera is from a place.
struct HeldDistance {
  int pose = -1;  // index into BundleProblem::poses
  Eigen::Vector3d place_in_world = Eigen::Vector3d::Zero();
  double distance = 0.0;  // metres

  double sigma() const { return 1e-4 * distance; }  // metres
};

// The covariance of one pose with all other moving poses and points free and the fixed ones true: the inverse of the
// robustly weighted normal matrix, with points and then poses eliminated (Schur complement). Of delta in
// exp_pose(delta) * camera_from_world. Empty where the observations do not determine the pose. Dense over the moving
// poses: cubic in their number, meant for windows.
std::optional<Matrix6> marginal_covariance(const BundleProblem& solved, const std::optional<HeldDistance>& scale,
                                           int pose, double huber_width);

// Indices of the observations in front of their cameras, those of one point side by side.
std::vector<int> observations_by_point(const BundleProblem& solved);

}  // namespace byre
