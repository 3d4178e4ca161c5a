// For tests: a base that drives and turns both ways, its wheel odometry, and poses of a camera on it.

#pragma once

#include "byre/body_motion.h"
#include "byre/odometry/wheel_calibration.h"
#include "byre/trajectory.h"

#include <cmath>
#include <random>

namespace byre {

struct Drive {
  Pose base_from_body;           // metres
  double metres_per_unit = 1.0;  // metres per unit of the map
  double wheel_delay = 0.0;      // seconds
  double noise = 0.0;            // standard deviation of the camera's poses, metres and radians

  // Pose of the base at a time. It drives at 0.5 m/s; its turn rate oscillates with an amplitude of 0.5 rad/s.
  static Pose world_from_base(double seconds) {
    constexpr double kStep = 0.01;
    static const std::vector<Pose> poses = [] {
      std::vector<Pose> path{Pose{}};
      for (double t = 0.0; t < 200.0; t += kStep) {
        const double yaw_rate = 0.5 * std::sin(0.4 * t) + 0.1;
        path.push_back(path.back() * Pose{rotation_exp({0.0, 0.0, yaw_rate * kStep}), {0.5 * kStep, 0.0, 0.0}});
      }
      return path;
    }();
    const double place = std::max(0.0, seconds) / kStep;
    const auto before = static_cast<std::size_t>(place);
    return interpolate(poses[before], poses[before + 1], place - static_cast<double>(before));
  }

  StampedPose wheels(double seconds) const { return {from_seconds(seconds + wheel_delay), world_from_base(seconds)}; }

  // Velocity of the base, measured by its wheels.
  BaseTwist velocity(double seconds) const {
    constexpr double kStep = 1e-3;
    const Pose motion = inverse(world_from_base(seconds - kStep)) * world_from_base(seconds + kStep);
    return {from_seconds(seconds + wheel_delay), motion.translation.x() / (2.0 * kStep),
            motion.translation.y() / (2.0 * kStep), rotation_log(motion.rotation).z() / (2.0 * kStep)};
  }

  // Visual pose, in the map's units and frame.
  Pose seen(double seconds, std::mt19937& random) const {
    std::normal_distribution<double> deviation(0.0, noise);
    const auto deviations = [&] { return Eigen::Vector3d(deviation(random), deviation(random), deviation(random)); };
    Pose body = inverse(base_from_body) * world_from_base(seconds) * base_from_body;
    body.translation /= metres_per_unit;
    return body * Pose{rotation_exp(deviations()), deviations() / metres_per_unit};
  }
};

// A camera that looks ahead, mounted 0.4 m ahead of the middle of the axle and 0.1 m to its left.
inline Pose camera_on_base() {
  Eigen::Matrix3d axes;
  axes << 0.0, 0.0, 1.0, -1.0, 0.0, 0.0, 0.0, -1.0, 0.0;
  return {Eigen::Quaterniond(axes) * rotation_exp({0.1, -0.05, 0.02}), {0.4, 0.1, 0.0}};
}

}  // namespace byre
