#pragma once

#include "byre/calibration.h"
#include "byre/io/ros/messages.h"
#include "byre/map/map_graph.h"
#include "byre/playback/play.h"
#include "byre/playback/report/odometry_message.h"

#include <optional>
#include <string>
#include <vector>

namespace byre {

// Conversion of byre's results to ROS messages. Frames follow REP-105: map -> odom -> base_link, byre's body.

inline constexpr const char* kMapFrame = "map";
inline constexpr const char* kOdometryFrame = "odom";
inline constexpr const char* kBodyFrame = "base_link";
inline constexpr const char* kLeftFrame = "left_camera";  // optical frame: x right, y down, z forward
inline constexpr const char* kRightFrame = "right_camera";

// State, health and numbers of matches, with the keys of JSON reports.
std::vector<ros::KeyValue> health_values(const FrameReport& report);

// OK for trusted, WARN for degraded, ERROR for untrusted.
std::byte diagnostic_level(Verdict verdict);
// "untrusted: pose is uncertain", or the verdict alone without a doubt.
std::string verdict_and_doubt(const Health& health);

// odom -> base_link if there is odometry; map -> odom if the map pose is not untrusted. Subscribers keep the last
// transform otherwise.
ros::TFMessage ros_transforms(const FrameReport& report);

// before: previous frame with odometry; empty for the first one. now: odometry_sample of the report, which has
// odometry.
ros::Odometry ros_odometry(const FrameReport& report, const std::optional<OdometrySample>& before,
                           const OdometrySample& now);

// Empty if the pose is untrusted or missing.
std::optional<ros::PoseWithCovarianceStamped> ros_map_pose(const FrameReport& report);

// Verdict as level, doubt as message, health and state as values. Frames without images are STALE.
ros::DiagnosticArray ros_diagnostics(int number, const PlayedFrame& frame);

ros::Path ros_path(const Trajectory& trajectory, Timestamp time);

// Points in the map frame: x, y, z, grey value from 0 to 255 (kUnknownGrey without one), number of observations.
ros::PointCloud2 ros_cloud(const MapGraph& map, Timestamp time);

// Camera extrinsics in the body frame.
ros::TFMessage ros_camera_extrinsics(const Calibration& calibration, Timestamp time);

ros::CameraInfo ros_camera_info(const Camera& camera, const std::string& frame, Timestamp time);
ros::Image ros_image(const Image& image, const std::string& frame, Timestamp time);

}  // namespace byre
