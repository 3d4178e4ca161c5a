#pragma once

#include "byre/optimise/bundle_adjustment.h"

#include <vector>

namespace byre {

// Current poses, points and change of the calibration, with cached rotation matrices.
struct BundleEstimate {
  std::vector<Pose> poses;
  std::vector<Eigen::Vector3d> points;
  CalibrationVector calibration = CalibrationVector::Zero();
  std::vector<Eigen::Matrix3d> rotations;  // rotation matrices of the poses

  void update_rotations() {
    rotations.resize(poses.size());
    for (std::size_t i = 0; i < poses.size(); ++i) rotations[i] = poses[i].rotation.toRotationMatrix();
  }
};

// A step and its expected gain under the quadratic model of the cost.
struct BundleStep {
  Eigen::VectorXd poses;                // six per slot: rotation, then translation
  std::vector<Eigen::Vector3d> points;  // one per track
  CalibrationVector calibration = CalibrationVector::Zero();
  double expected_gain = 0.0;
  double squared_length = 0.0;
};

}  // namespace byre
