#pragma once

#include "byre/rig.h"

#include <Eigen/Core>

namespace byre {

// Below this depth the inverse depth continues along its tangent. A point that moves behind a camera during
// optimisation then has a finite error that grows with its distance behind it.
inline constexpr double kNearestDepth = 0.01;  // metres

struct InverseDepth {
  double value;
  double derivative;  // by the depth
};

inline InverseDepth inverse_depth(double depth) {
  constexpr double kSteepest = 1.0 / kNearestDepth;
  if (depth < kNearestDepth) return {kSteepest * (2.0 - kSteepest * depth), -kSteepest * kSteepest};
  const double value = 1.0 / depth;
  return {value, -value * value};
}

// Residual of one measurement in a rectified image: projected minus measured (u, v, disparity) in sigmas. Without a
// disparity (disparity_sigma negative) the third component is zero.
class Reprojection {
 public:
  Reprojection(const Rig& rig, const StereoPixel& measured, double pixel_sigma, double disparity_sigma) {
    const double per_pixel = 1.0 / pixel_sigma;
    scale_ << per_pixel * rig.focal, per_pixel * rig.focal, 0.0;
    offset_ << per_pixel * (rig.cx - measured.x()), per_pixel * (rig.cy - measured.y()), 0.0;
    if (disparity_sigma <= 0.0) return;
    scale_.z() = rig.focal * rig.baseline / disparity_sigma;
    offset_.z() = -measured.z() / disparity_sigma;
  }

  Eigen::Vector3d residual(const Eigen::Vector3d& point_in_camera) const {
    return inverse_depth(point_in_camera.z()).value * scale_.cwiseProduct(at_unit_depth(point_in_camera)) + offset_;
  }

  // d(residual) / d(point_in_camera).
  Eigen::Matrix3d jacobian(const Eigen::Vector3d& point_in_camera) const {
    const InverseDepth inverse = inverse_depth(point_in_camera.z());
    Eigen::Matrix3d jacobian = Eigen::Matrix3d::Zero();
    jacobian(0, 0) = scale_.x() * inverse.value;
    jacobian(1, 1) = scale_.y() * inverse.value;
    jacobian.col(2) = inverse.derivative * scale_.cwiseProduct(at_unit_depth(point_in_camera));
    return jacobian;
  }

 private:
  static Eigen::Vector3d at_unit_depth(const Eigen::Vector3d& point) { return {point.x(), point.y(), 1.0}; }

  // residual = scale * (x, y, 1) / z + offset. Constant after construction.
  Eigen::Vector3d scale_;
  Eigen::Vector3d offset_;
};

}  // namespace byre
