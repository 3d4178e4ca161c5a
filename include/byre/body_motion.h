#pragma once

#include "byre/pose.h"
#include "byre/trajectory.h"

#include <optional>
#include <vector>

#include <Eigen/Core>

namespace byre {

// How the body moved from one moment to a later one, as something else than the camera tells it.
struct BodyMotion {
  // With the covariance of ordinary wheels: 2 % of the way and of the turn, and 1 degree on each metre.
  BodyMotion(const Pose& earlier_from_later);  // NOLINT(google-explicit-constructor): a pose is a motion
  BodyMotion(const Pose& earlier_from_later, const Matrix6& motion_covariance)
      : last_from_body(earlier_from_later), covariance(motion_covariance) {}

  Pose last_from_body;  // metres
  Matrix6 covariance;   // covariance of delta in last_from_body * exp_pose(delta)
};

inline BodyMotion no_motion() {
  return {Pose{}, Matrix6::Zero()};
}

// One motion after another. What errs in both is taken to be the same, as the radius of a wheel or the bias of a
// gyroscope is: deviations add up, not variances.
BodyMotion operator*(const BodyMotion& first, const BodyMotion& second);

// How fast wheels say that the robot's base moves, in the base's own axes. One whose wheels drive it ahead alone has
// nothing to the left.
struct BaseVelocity {
  Timestamp time{};
  double ahead = 0.0;    // metres per second
  double left = 0.0;     // metres per second
  double turning = 0.0;  // radians per second, to the left
};

// What a gyroscope tells.
struct AngularRate {
  Timestamp time{};
  Eigen::Vector3d rate = Eigen::Vector3d::Zero();  // radians per second, about the gyroscope's own axes
};

// What an accelerometer tells. At rest it points up, as long as gravity.
struct Acceleration {
  Timestamp time{};
  Eigen::Vector3d acceleration = Eigen::Vector3d::Zero();  // m/s^2, about the axes of the gyroscope beside it
};

// What was recorded of a robot's motion beside its images.
struct MotionSamples {
  Trajectory wheels;                        // poses of the robot's base in a frame of the wheels' own
  std::vector<BaseVelocity> velocities;     // motion of wheels that tell no poses, in order of time
  std::vector<AngularRate> rates;           // in order of time
  std::vector<Acceleration> accelerations;  // in order of time
  // How the gyroscope is turned against the left camera, where the recording says so.
  std::optional<Eigen::Quaterniond> left_from_gyroscope;
};

}  // namespace byre
