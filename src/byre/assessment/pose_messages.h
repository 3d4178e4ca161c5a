#pragma once

#include "byre/pose.h"
#include "byre/ros/messages.h"
#include "byre/trajectory.h"

#include <array>
#include <optional>
#include <string>

namespace byre {

ros::Pose ros_pose(const Pose& parent_from_child);
ros::TransformStamped transform_message(const ros::Header& header, const std::string& child_frame,
                                        const Pose& parent_from_child);

// ROS has covariances of rotations about the parent's fixed axes and of positions along them, byre those of a small
// motion as seen in the child.
std::array<double, 36> ros_covariance(const Matrix6& covariance_in_child, const Eigen::Quaterniond& parent_from_child);

ros::PoseWithCovarianceStamped pose_message(const ros::Header& header, const Pose& parent_from_child,
                                            const Matrix6& covariance_in_child);

// How a body moved from one pose to the next, per second, as seen in itself.
ros::Twist twist_between(const Pose& parent_from_before, const Pose& parent_from_after, Timestamp passed);

}  // namespace byre
