#pragma once

#include "byre/body_motion.h"
#include "byre/ros/messages.h"

#include <optional>

namespace byre {

// A pose of ROS; empty where it holds no numbers, or no rotation.
std::optional<Pose> pose_of(const ros::Pose& message);

// The pose of a robot's base as its wheels tell it, with the time given; empty where the message holds no numbers, or
// no rotation.
std::optional<StampedPose> sample_of(const ros::Odometry& message, Timestamp time);

// What a gyroscope tells, likewise.
std::optional<AngularRate> sample_of(const ros::Imu& message, Timestamp time);

}  // namespace byre
