#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace byre {

// How far programs of ROS 2 look for one another by themselves, as ROS_AUTOMATIC_DISCOVERY_RANGE has it.
//   subnet     in the local network
//   localhost  on this computer
//   off        nowhere: peers are named
//   system     wherever the middleware's own settings say
enum class DiscoveryRange : std::uint8_t { subnet, localhost, off, system };

// Releases of ROS 2 in which programs tell their nodes to one another in the same way.
//   humble    and before: ids of 24 bytes, no hashes of types
//   jazzy     and all others from Iron on: ids of 16 bytes, hashes of types
enum class RosDistribution : std::uint8_t { humble, jazzy };

// Where ROS is said to be, by the variables of the environment that its own programs heed.
struct RosNetwork {
  int domain = 0;
  DiscoveryRange range = DiscoveryRange::subnet;
  std::vector<std::string> peers{};  // addresses of computers to ask as well
  RosDistribution distribution = RosDistribution::jazzy;
  bool has_cyclone = false;  // whether its programs are by Cyclone DDS
};

// An environment variable's text; empty where it is not set.
using Environment = std::function<std::optional<std::string>(const char* name)>;

Environment program_environment();

// The distribution by its name, as "humble": all before Iron count as humble. Empty for what is no name.
std::optional<RosDistribution> distribution_of(std::string_view name);

// From ROS_DOMAIN_ID, ROS_LOCALHOST_ONLY, ROS_AUTOMATIC_DISCOVERY_RANGE, ROS_STATIC_PEERS, ROS_DISTRO and
// RMW_IMPLEMENTATION. Throws InputError for a value that is none of a variable's.
RosNetwork read_ros_network(const Environment& environment);

// The settings of Cyclone DDS that do that, as XML. own_settings: CYCLONEDDS_URI, which wins over the variables of ROS.
std::string cyclone_settings(const RosNetwork& network, const std::string& own_settings);

}  // namespace byre
