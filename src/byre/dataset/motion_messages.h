#pragma once

#include "byre/body_motion.h"
#include "byre/ros/messages.h"

#include <optional>

namespace byre {

// The pose of a robot's base as its wheels tell it, with the time given; empty where the message holds no numbers, or
// no rotation.
std::optional<StampedPose> sample_of(const ros::Odometry& message, Timestamp time);

// What a gyroscope tells, likewise.
std::optional<AngularRate> sample_of(const ros::Imu& message, Timestamp time);

}  // namespace byre
