#pragma once

#include "byre/body_motion.h"
#include "byre/io/bag/bag.h"
#include "byre/io/recording/restored_times.h"
#include "byre/io/ros/messages.h"
#include "byre/recording.h"

#include <optional>
#include <string>
#include <string_view>
#include <vector>

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

// Samples of motion sensors recorded with images.
struct SensorMotion {
  MotionSamples samples;
  std::vector<std::string> warnings;  // corrections of times and dropped lines, with counts
};

// Whether the options require messages of this type, other than images.
bool is_motion_type(std::string_view type, const OpenOptions& options);

// Samples of wheels and gyroscope, with header times:
//   wheels      nav_msgs/Odometry: its poses, or its twists if the poses never change; geometry_msgs/TwistStamped or
//               TwistWithCovarianceStamped. From the topic or the file that the options name.
//   gyroscope   sensor_msgs/Imu. From the topic that the options name; from the only one if they name none.
// place: name of the bag in errors and warnings. Warnings count damaged and non-finite messages, and corrections of
// times. images: clock of the left images. Throws InputError, with a list of topics of that kind, for an absent topic
// and if several topics qualify.
SensorMotion read_bag_motion(Bag& bag, const OpenOptions& options, const std::string& place,
                             const SensorClock& images = {});

}  // namespace byre
