#pragma once

#include "byre/io/ros/services.h"
#include "byre/ros2/node/node_config.h"

// Settings of a node as ROS parameters, all read-only. Answers have the order and length of the request; unknown
// parameters have the type kNotSet, as in rclpy.
namespace byre {

// Names below the prefixes, or all without a prefix, down to a depth, as in rclcpp.
ros::ListParameters::Response parameter_names(const ros::ListParameters::Request& request);

ros::GetParameters::Response parameter_values(const NodeConfig& config, const ros::GetParameters::Request& request);
ros::GetParameterTypes::Response parameter_types(const NodeConfig& config,
                                                 const ros::GetParameterTypes::Request& request);
ros::DescribeParameters::Response parameter_descriptions(const NodeConfig& config,
                                                         const ros::DescribeParameters::Request& request);

// Refusals with their reasons.
ros::SetParameters::Response refused_parameters(const ros::SetParameters::Request& request);
ros::SetParametersAtomically::Response refused_parameters(const ros::SetParametersAtomically::Request& request);

}  // namespace byre
