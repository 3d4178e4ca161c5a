#pragma once

#include "byre/optimise/bundle_adjustment.h"

#include <vector>

namespace byre {

// Poses, points and the change of the calibration, and what is looked up again and again.
struct BundleEstimate {
  std::vector<Pose> poses;
  std::vector<Eigen::Vector3d> points;
  CalibrationVector calibration = CalibrationVector::Zero();
  std::vector<Eigen::Matrix3d> rotations;  // turns of the poses

  void update_rotations() {
    rotations.resize(poses.size());
    for (std::size_t i = 0; i < poses.size(); ++i) rotations[i] = poses[i].rotation.toRotationMatrix();
  }
};

// A step, and what it would gain were the costs quadratic.
struct BundleStep {
  Eigen::VectorXd poses;                // six a slot: turn, then translation
  std::vector<Eigen::Vector3d> points;  // one a track
  CalibrationVector calibration = CalibrationVector::Zero();
  double expected_gain = 0.0;
  double squared_length = 0.0;
};

}  // namespace byre
