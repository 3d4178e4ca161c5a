#pragma once

#include "byre/calibration.h"
#include "byre/frame_report.h"
#include "byre/io/ros/messages.h"
#include "byre/map/map_graph.h"
#include "byre/playback/play.h"
#include "byre/pose.h"
#include "byre/trajectory.h"

#include <array>
#include <optional>
#include <string>
#include <vector>

namespace byre {

ros::Pose ros_pose(const Pose& parent_from_child);
ros::TransformStamped transform_message(const ros::Header& header, const std::string& child_frame,
                                        const Pose& parent_from_child);

// Converts to the convention of ROS: rotations about the parent's fixed axes and positions along them. byre's
// covariances are of a small motion in the child's frame.
std::array<double, 36> ros_covariance(const Matrix6& covariance_in_child, const Eigen::Quaterniond& parent_from_child);

ros::PoseWithCovarianceStamped pose_message(const ros::Header& header, const Pose& parent_from_child,
                                            const Matrix6& covariance_in_child);

// Mean velocity between two poses in the body frame.
ros::Twist twist_between(const Pose& parent_from_before, const Pose& parent_from_after, Timestamp passed);

// Variance of each axis of a twist that is not known, as other ROS drivers write it.
inline constexpr double kUnknownVariance = 1e6;

// Smooth odometry of a frame.
struct OdometrySample {
  Timestamp time{};
  Pose odom_from_base;
  // Covariance of the pose in the map around the camera, in the base frame: an upper bound, without the drift that
  // consecutive frames share. Zero if it is not known.
  Matrix6 covariance = Matrix6::Zero();
};

// Sample of a report with odometry. Both covariances of the report contain that of the matches: that of odometry adds
// the drift since the start, that of the map pose adds the map's. The smaller one bounds it.
OdometrySample odometry_sample(const FrameReport& report, const Pose& odom_from_base);

// Mean velocity between two frames, in the base frame of the second one. Covariance: errors of the two poses as if they
// were independent (those of frames that share points partly cancel), and the change of velocity between mean and
// stamp. Positive definite; kUnknownVariance without an earlier frame, or if a covariance is not known.
ros::TwistWithCovariance twist_message(const std::optional<OdometrySample>& before, const OdometrySample& now);

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
