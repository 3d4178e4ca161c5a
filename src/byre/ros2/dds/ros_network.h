#pragma once

#include "byre/io/ros/message_bytes.h"

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

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

// Range of automatic discovery, as in ROS_AUTOMATIC_DISCOVERY_RANGE.
//   subnet     local network
//   localhost  this computer
//   off        named peers only
//   system     as configured in the middleware
enum class DiscoveryRange : std::uint8_t { subnet, localhost, off, system };

// Groups of ROS 2 releases with equal discovery messages.
//   humble    up to Humble: ids of 24 bytes, no type hashes
//   jazzy     from Iron on: ids of 16 bytes, type hashes
enum class RosDistribution : std::uint8_t { humble, jazzy };

// ROS network settings from the standard environment variables.
struct RosNetwork {
  int domain = 0;
  DiscoveryRange range = DiscoveryRange::subnet;
  std::vector<std::string> peers{};  // addresses of further computers for discovery
  RosDistribution distribution = RosDistribution::jazzy;
  bool uses_cyclone = false;  // whether RMW_IMPLEMENTATION is Cyclone DDS
};

// Value of an environment variable; empty if unset.
using Environment = std::function<std::optional<std::string>(const char* name)>;

Environment program_environment();

// Distribution of a release name such as "humble"; names before Iron map to humble. Empty for an invalid name.
std::optional<RosDistribution> distribution_of(std::string_view name);

// Reads ROS_DOMAIN_ID, ROS_LOCALHOST_ONLY, ROS_AUTOMATIC_DISCOVERY_RANGE, ROS_STATIC_PEERS, ROS_DISTRO and
// RMW_IMPLEMENTATION. Throws InputError for an invalid value.
RosNetwork read_ros_network(const Environment& environment);

// Cyclone DDS configuration, XML. own_settings: CYCLONEDDS_URI, which overrides the ROS variables.
std::string cyclone_settings(const RosNetwork& network, const std::string& own_settings);

}  // namespace byre
