#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace byre {

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
