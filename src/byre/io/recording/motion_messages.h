#pragma once

#include "byre/body_motion.h"
#include "byre/io/ros/messages.h"

#include <optional>

namespace byre {

// A pose of ROS; empty if numbers are not finite, or the quaternion is not a rotation.
std::optional<Pose> pose_of(const ros::Pose& message);

// Sample of one wheel message: pose of the base, velocity, or both.
struct WheelSample {
  Timestamp time{};
  std::optional<Pose> pose{};           // in the odometry frame
  std::optional<BaseTwist> velocity{};  // in the plane of the base
};

// Sample at the given time; empty if numbers are not finite. Odometry has no pose if its covariance begins with a
// negative number or its orientation is all zeros.
std::optional<WheelSample> sample_of(const ros::Odometry& message, Timestamp time);
std::optional<WheelSample> sample_of(const ros::TwistStamped& message, Timestamp time);
std::optional<WheelSample> sample_of(const ros::TwistWithCovarianceStamped& message, Timestamp time);

// Rate and acceleration by one sensor.
struct ImuSample {
  Timestamp time{};
  std::optional<AngularRate> rate{};  // empty if the message marks it as not measured
  std::optional<Acceleration> acceleration{};
};

// A sample at the given time; empty if a measured rate is not finite. A covariance that begins with -1 marks rates or
// accelerations as not measured (sensor_msgs/Imu). Zero accelerations are dropped.
std::optional<ImuSample> sample_of(const ros::Imu& message, Timestamp time);

// Warning for a topic whose messages mark rates as not measured.
inline constexpr const char* kRatesNotMeasured =
    "angular_velocity_covariance[0] is -1, which marks rates as not measured; these messages are ignored; choose the "
    "topic of the gyroscope, or correct the driver";

}  // namespace byre
