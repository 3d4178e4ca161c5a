#pragma once

#include "byre/optimise/bundle_adjustment.h"
#include "byre/optimise/bundle_covariance.h"

#include <optional>
#include <vector>

namespace byre {

// What takes part in the solution of a bundle problem.
struct BundleRoles {
  std::vector<bool> pose_moves;
  std::vector<bool> point_moves;
  std::vector<int> observations;  // indices: in front of the camera, and not between two fixed things; by point
  std::vector<int> motions;       // indices: not between two fixed poses

  bool moves(const BundleObservation& observation) const {
    return pose_moves[observation.pose] || point_moves[observation.point];
  }
};

BundleRoles choose_roles(const BundleProblem& problem);

// What must be held for the scale to be determined; nothing where it is.
std::optional<HeldDistance> choose_scale(const BundleProblem& problem, const BundleRoles& roles);

// What a solver has come to.
struct BundleSolution {
  std::vector<Pose> camera_from_world;           // one per pose
  std::vector<Eigen::Vector3d> points_in_world;  // one per point
  CalibrationVector calibration_change = CalibrationVector::Zero();
  std::vector<Matrix6> pose_covariances;  // see BundleResult
  int iterations = 0;
  bool usable = false;
};

}  // namespace byre
