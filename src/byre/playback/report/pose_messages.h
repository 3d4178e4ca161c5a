#pragma once

#include "byre/io/ros/messages.h"
#include "byre/pose.h"
#include "byre/trajectory.h"

#include <array>
#include <optional>
#include <string>

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

}  // namespace byre
