#pragma once

#include "byre/frame_report.h"
#include "byre/io/ros/messages.h"
#include "byre/pose.h"
#include "byre/trajectory.h"

#include <optional>

namespace byre {

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

}  // namespace byre
