#pragma once

#include "byre/calibration.h"
#include "byre/map/map.h"
#include "byre/playback/map_run.h"
#include "byre/ros/messages.h"

#include <optional>
#include <string>

namespace byre {

// What byre knows, as messages of ROS. Frames are those of REP-105: map -> odom -> base_link, which is byre's body.

inline constexpr const char* kMapFrame = "map";
inline constexpr const char* kOdometryFrame = "odom";
inline constexpr const char* kBodyFrame = "base_link";
inline constexpr const char* kLeftFrame = "left_camera";  // optical: x right, y down, z forward
inline constexpr const char* kRightFrame = "right_camera";

// OK for trusted, WARN for degraded, ERROR for untrusted.
std::byte diagnostic_level(Verdict verdict);
// "untrusted: pose is uncertain", or the verdict alone where there is no doubt.
std::string verdict_and_doubt(const Health& health);

// odom -> base_link while there is odometry, and map -> odom while the pose in the map is not untrusted: else whoever
// needs it goes on with the last one.
ros::TFMessage ros_transforms(const FrameReport& report);

// Motion is that since the frame before; none without one.
ros::Odometry ros_odometry(const FrameReport& report, const std::optional<StampedPose>& before);

// Empty while the pose is untrusted or not known.
std::optional<ros::PoseWithCovarianceStamped> ros_map_pose(const FrameReport& report);

// Verdict as level, doubt as message, health and state as values. A frame without images is stale.
ros::DiagnosticArray ros_diagnostics(int number, const MappedFrame& frame);

ros::Path ros_path(const Trajectory& trajectory, Timestamp time);

// Points of a map, in its frame: x, y, z and the number of observations.
ros::PointCloud2 ros_cloud(const Map& map, Timestamp time);

// Where the cameras are in the body.
ros::TFMessage ros_mounts(const Calibration& calibration, Timestamp time);

ros::CameraInfo ros_camera_info(const Camera& camera, const std::string& frame, Timestamp time);
ros::Image ros_image(const Image& image, const std::string& frame, Timestamp time);

}  // namespace byre
