#pragma once

#include "byre/body_motion.h"
#include "byre/ros/messages.h"

#include <optional>

namespace byre {

// A pose of ROS; empty where it holds no numbers, or no rotation.
std::optional<Pose> pose_of(const ros::Pose& message);

// What one message of wheels tells: where the base is, how fast it moves, or both.
struct WheelSample {
  Timestamp time{};
  std::optional<Pose> pose{};              // in the wheels' own frame
  std::optional<BaseVelocity> velocity{};  // in the plane that it drives in
};

// With the time given; empty where the message holds no numbers. Odometry whose covariance begins below zero, or whose
// orientation is zeros alone, has no pose.
std::optional<WheelSample> sample_of(const ros::Odometry& message, Timestamp time);
std::optional<WheelSample> sample_of(const ros::TwistStamped& message, Timestamp time);
std::optional<WheelSample> sample_of(const ros::TwistWithCovarianceStamped& message, Timestamp time);

// What a gyroscope tells, and the accelerometer beside it.
struct ImuSample {
  AngularRate rate;
  std::optional<Acceleration> acceleration{};
};

// With the time given; empty where the rates are no numbers. Without an acceleration where the message says that there
// is none, and where it holds zeros alone.
std::optional<ImuSample> sample_of(const ros::Imu& message, Timestamp time);

}  // namespace byre
