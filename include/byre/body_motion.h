#pragma once

#include "byre/pose.h"
#include "byre/trajectory.h"

#include <optional>
#include <vector>

#include <Eigen/Core>

namespace byre {

// Motion of the body between two times, measured by another sensor than the camera.
struct BodyMotion {
  // With the covariance of ordinary wheels: 2 % of path and turn, and 1 degree per metre (one sigma).
  BodyMotion(const Pose& earlier_from_later);  // NOLINT(google-explicit-constructor): a pose is a motion
  BodyMotion(const Pose& earlier_from_later, const Matrix6& motion_covariance)
      : last_from_body(earlier_from_later), covariance(motion_covariance) {}

  Pose last_from_body;  // pose at the later time in the frame of the earlier one, metres
  Matrix6 covariance;   // covariance of delta in last_from_body * exp_pose(delta)
};

// Standstill, without uncertainty.
inline BodyMotion no_motion() {
  return {Pose{}, Matrix6::Zero()};
}

// Concatenates two motions. Errors are taken as fully correlated, as from a wheel radius or a gyroscope bias: standard
// deviations add up, not variances.
BodyMotion operator*(const BodyMotion& first, const BodyMotion& second);

// Planar velocity of the robot's base, in its own axes: x ahead, y left. vy is zero for differential drives.
struct BaseTwist {
  Timestamp time{};
  double vx = 0.0;  // metres per second
  double vy = 0.0;  // metres per second
  double wz = 0.0;  // radians per second, positive to the left
};

// Sample of a gyroscope.
struct AngularRate {
  Timestamp time{};
  Eigen::Vector3d rate = Eigen::Vector3d::Zero();  // radians per second, about the gyroscope's axes
};

// Sample of an accelerometer: specific force. At rest it points up and has the length of gravity.
struct Acceleration {
  Timestamp time{};
  Eigen::Vector3d acceleration = Eigen::Vector3d::Zero();  // m/s^2, along the axes of the gyroscope
};

// Motion measurements of a recording. Each list is in order of time.
struct MotionSamples {
  Trajectory wheels;                  // wheel odometry: poses of the base in the odometry frame
  std::vector<BaseTwist> velocities;  // wheel odometry that measures velocities only
  std::vector<AngularRate> rates;
  std::vector<Acceleration> accelerations;
  // Rotation from gyroscope to left camera; empty if the recording does not contain it.
  std::optional<Eigen::Quaterniond> left_from_gyroscope;
};

}  // namespace byre
