#pragma once

#include "byre/optimise/calibration_border.h"
#include "byre/optimise/trust_region.h"

#include <cstdint>

#include <Eigen/Cholesky>
#include <Eigen/Core>

namespace byre {

// One observation. What follows from it is worked out anew each time: kept, it would take several times the memory.
struct BundleTerm {
  int seen = 0;   // index into the problem's observations
  int slot = -1;  // place of the pose in the reduced system; negative for one that stays
};

// The observations of one point: terms [begin, end).
struct BundleTrack {
  int point = 0;
  std::uint32_t begin = 0;
  std::uint32_t end = 0;
  bool moves = false;
};

// An observation's error at an estimate, and its slopes.
struct LinearObservation {
  Eigen::Vector3d residual;
  double weight = 1.0;
  Eigen::Matrix3d by_point;
  Eigen::Matrix<double, 3, 6> by_pose;      // for a pose that moves
  CalibrationBorder::Slope by_calibration;  // where one is sought
};

// The normal equations of one point, to eliminate it by, and to find it by once the poses' steps are known.
class PointEquations {
 public:
  void add(const LinearObservation& linear) {
    normal_.noalias() += linear.weight * linear.by_point.transpose() * linear.by_point;
    gradient.noalias() += linear.weight * linear.by_point.transpose() * linear.residual;
  }
  // When all views are added.
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
