#pragma once

#include "byre/odometry/visual_motion.h"

#include <deque>
#include <optional>

namespace byre {

// Rotation of the gyroscope relative to the body, and its bias.
struct GyroscopeCalibration {
  Eigen::Quaterniond body_from_gyroscope = Eigen::Quaterniond::Identity();
  Eigen::Vector3d bias = Eigen::Vector3d::Zero();  // radians per second, about the gyroscope's axes
  double error = 0.0;                              // median difference from turns in images, radians per second
  // Covariance of a small rotation of body_from_gyroscope, about the body's axes. Wide about the axis of all turns, if
  // they have only one; wide about all axes before any turn.
  Eigen::Matrix3d covariance = kOpenTurn * Eigen::Matrix3d::Identity();

  static constexpr double kOpenTurn = 3.3;  // square radians, unconstrained
};

// Estimates the calibration from turns in images; the bias is that of the last 30 s. If all turns share one axis, the
// rotation about it stays unconstrained; it does not affect such turns. Empty if the turns are too small, or differ
// from the gyroscope's by too much.
// known: estimate of an earlier drive, a prior. With it, two seconds determine the bias, also at standstill.
std::optional<GyroscopeCalibration> estimate_gyroscope_calibration(
    const std::deque<VisualMotion>& seen, const std::optional<GyroscopeCalibration>& known = {});

}  // namespace byre
