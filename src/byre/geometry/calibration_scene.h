#pragma once

#include "byre/geometry/calibration_sensitivity.h"

#include <random>

namespace byre {

// A stereo pair like those of small drones: 80 degrees wide, barrel distortion, slightly non-parallel.
inline Calibration scene_calibration() {
  const Camera left{.model = CameraModel::radial_tangential,
                    .width = 752,
                    .height = 480,
                    .fx = 458.7,
                    .fy = 457.3,
                    .cx = 367.2,
                    .cy = 248.4,
                    .distortion = {-0.283, 0.074, 0.0002, 0.00002, 0.0}};
  Camera right = left;
  right.fx = 457.6;
  right.cx = 380.0;
  right.cy = 255.2;
  const Pose left_from_right{rotation_exp({0.004, -0.012, 0.009}), {0.11, 0.001, -0.0005}};
  return {left, StereoPartner{right, inverse(left_from_right)}, Pose{}};
}

// A typical error of a good calibration, times level.
inline CalibrationVector draw_error(std::uint64_t seed, double level = 1.0) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal(0.0, level);
  CalibrationVector error;
  for (double& value : error) value = normal(random);
  return error;
}

// Measurement (u, v, disparity, row offset) of a point by cameras like `truth`, with images rectified by `given`.
inline Eigen::Vector4d measured(const Calibration& truth, const Calibration& given, const Rectification& rectification,
                                const Eigen::Vector3d& point_in_left) {
  const Rig& rig = rectification.rig;
  const Eigen::Vector3d seen_left = given.left.bearing(truth.left.project(point_in_left).value()).value();
  const Eigen::Vector2d left = rig.project(rectification.left_from_rectified.conjugate() * seen_left).head<2>();
  const Eigen::Vector3d point_in_right = truth.right->right_from_left * point_in_left;
  const Eigen::Vector3d seen_right =
      given.right->camera.bearing(truth.right->camera.project(point_in_right).value()).value();
  const Eigen::Vector2d right = rig.project(rectification.right_from_rectified.conjugate() * seen_right).head<2>();
  return {left.x(), left.y(), left.x() - right.x(), right.y() - left.y()};
}

}  // namespace byre
