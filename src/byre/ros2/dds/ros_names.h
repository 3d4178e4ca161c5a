#pragma once

#include "byre/io/ros/message.h"

#include <string>
#include <string_view>

namespace byre {

// ROS message type by name, such as "sensor_msgs/msg/Image", and type hash as compared since Iron: RIHS01_ and 64
// hexadecimal digits, or empty if unknown.
struct MessageType {
  std::string name;
  std::string hash;
};

// ROS 2 names in DDS, https://design.ros2.org/articles/topic_and_service_names.html
std::string dds_topic_name(std::string_view topic);      // "/left/image_raw": "rt/left/image_raw"
std::string dds_request_name(std::string_view service);  // "/byre/save": "rq/byre/saveRequest"
std::string dds_reply_name(std::string_view service);    // "/byre/save": "rr/byre/saveReply"
std::string dds_type_name(std::string_view type_name);   // "sensor_msgs/msg/Image": "sensor_msgs::msg::dds_::Image_"
std::string ros_type_name(std::string_view dds_type);    // inverse; "" for types that are not of ROS

// Fault of an absolute topic name or node namespace; empty if valid.
std::string fault_in_name(std::string_view name);

// Full topic name: relative topics are within the namespace.
std::string resolve_name(std::string_view topic, std::string_view name_space);

// Type hash of a message (REP-2011: RIHS01_ and 64 digits); empty for messages that are only sent as parts.
std::string_view type_hash(std::string_view type_name);

template <ros::Message T>
MessageType message_type() {
  return {std::string(T::kType), std::string(type_hash(T::kType))};
}

}  // namespace byre
