#pragma once

#include <string>
#include <string_view>

namespace byre {

// A message of ROS by its name, as "sensor_msgs/msg/Image", and the hash of its fields that Iron and later compare:
// RIHS01_ and 64 hexadecimal digits. Empty: it is not known.
struct MessageType {
  std::string name;
  std::string hash;
};

// Names as ROS 2 has them in DDS, https://design.ros2.org/articles/topic_and_service_names.html
std::string dds_topic_name(std::string_view topic);      // "/left/image_raw": "rt/left/image_raw"
std::string dds_request_name(std::string_view service);  // "/byre/save": "rq/byre/saveRequest"
std::string dds_reply_name(std::string_view service);    // "/byre/save": "rr/byre/saveReply"
std::string dds_type_name(std::string_view type_name);   // "sensor_msgs/msg/Image": "sensor_msgs::msg::dds_::Image_"
std::string ros_type_name(std::string_view dds_type);    // the other way; "" where it is none of ROS

// What is wrong with the name of a topic, or of a node's namespace, that begins with a slash; empty where nothing is.
std::string fault_in_name(std::string_view name);

// A topic that a node is told of: one that begins with a slash as it is, others within the node's namespace.
std::string resolved(std::string_view topic, std::string_view name_space);

}  // namespace byre
