#pragma once

#include "byre/optimise/bundle_adjustment.h"
#include "byre/optimise/calibration_border.h"
#include "byre/optimise/trust_region.h"

#include <cstdint>
#include <vector>

#include <Eigen/Cholesky>
#include <Eigen/Core>

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

// One observation. Residual and derivatives are recomputed, because storing them takes several times the memory.
struct BundleTerm {
  int seen = 0;   // index into BundleProblem::observations
  int slot = -1;  // index of the pose in the reduced system; negative for a fixed pose
};

// The observations of one point: terms [begin, end).
struct BundleTrack {
  int point = 0;
  std::uint32_t begin = 0;
  std::uint32_t end = 0;
  bool moves = false;
};

// Residual of an observation at an estimate, and its derivatives.
struct LinearObservation {
  Eigen::Vector3d residual;
  double weight = 1.0;
  Eigen::Matrix3d by_point;
  Eigen::Matrix<double, 3, 6> by_pose;         // set for a moving pose
  CalibrationBorder::Jacobian by_calibration;  // set with self-calibration
};

// Normal equations of one point, for its elimination and for its step once the steps of the poses are given.
class PointEquations {
 public:
  void add(const LinearObservation& linear) {
    normal_.noalias() += linear.weight * linear.by_point.transpose() * linear.by_point;
    gradient.noalias() += linear.weight * linear.by_point.transpose() * linear.residual;
  }
  // Precondition: all observations are added.
  void damp(double radius) {
    damping = normal_.diagonal().unaryExpr(&bounded) / radius;
    normal_.diagonal() += damping;
    covariance = normal_.llt().solve(Eigen::Matrix3d::Identity());
  }

  Eigen::Vector3d gradient = Eigen::Vector3d::Zero();
  Eigen::Vector3d damping;
  Eigen::Matrix3d covariance;  // inverse of the damped normal matrix

 private:
  Eigen::Matrix3d normal_ = Eigen::Matrix3d::Zero();
};

}  // namespace byre
