#pragma once

#include "byre/optimise/bundle_adjustment.h"
#include "byre/optimise/bundle_covariance.h"

#include <optional>
#include <vector>

namespace byre {

// Parts of a bundle problem that take part in the solution.
struct BundleRoles {
  std::vector<bool> pose_moves;
  std::vector<bool> point_moves;
  std::vector<int> observations;  // indices by point: in front of the camera, with a moving pose or point
  std::vector<int> motions;       // indices: not between two fixed poses

  bool moves(const BundleObservation& observation) const {
    return pose_moves[observation.pose] || point_moves[observation.point];
  }
};

BundleRoles choose_roles(const BundleProblem& problem);

// The distance to hold if the scale is undetermined, else empty.
std::optional<FixedDistance> choose_scale(const BundleProblem& problem, const BundleRoles& roles);

struct BundleSolution {
  std::vector<Pose> camera_from_world;           // one per pose
  std::vector<Eigen::Vector3d> points_in_world;  // one per point
  CalibrationVector calibration_change = CalibrationVector::Zero();
  std::vector<Matrix6> pose_covariances;  // see BundleResult
  int iterations = 0;
  bool usable = false;
};

}  // namespace byre
