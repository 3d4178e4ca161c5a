#include "byre/ros2/dds/ros_network.h"

#include "byre/base/markup.h"
#include "byre/input_error.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cstdlib>
#include <utility>

namespace byre {
namespace {

constexpr int kMaxDomain = 232;  // largest domain with valid ports

int read_domain(const Environment& environment) {
  const std::string text = environment("ROS_DOMAIN_ID").value_or("");
  if (text.empty()) return 0;
  int domain = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), domain);
  const bool is_number = error == std::errc{} && end == text.data() + text.size();
  if (!is_number || domain < 0 || domain > kMaxDomain) {
    throw InputError("ROS_DOMAIN_ID", "is '" + text + "', which is not a domain",
                     "set a number from 0 to 232, or unset it");
  }
  return domain;
}

DiscoveryRange read_range(const Environment& environment) {
  if (environment("ROS_LOCALHOST_ONLY") == "1") return DiscoveryRange::localhost;
  constexpr std::array<std::pair<std::string_view, DiscoveryRange>, 5> kNames = {
      {{"", DiscoveryRange::subnet},
       {"SUBNET", DiscoveryRange::subnet},
       {"LOCALHOST", DiscoveryRange::localhost},
       {"OFF", DiscoveryRange::off},
       {"SYSTEM_DEFAULT", DiscoveryRange::system}}};
  const std::string text = environment("ROS_AUTOMATIC_DISCOVERY_RANGE").value_or("");
  const auto* const found = std::ranges::find(kNames, text, &std::pair<std::string_view, DiscoveryRange>::first);
  if (found == kNames.end()) {
    throw InputError("ROS_AUTOMATIC_DISCOVERY_RANGE", "is '" + text + "', which is not a range",
                     "set SUBNET, LOCALHOST, OFF or SYSTEM_DEFAULT");
  }
  return found->second;
}

std::vector<std::string> read_peers(const Environment& environment) {
  const std::string text = environment("ROS_STATIC_PEERS").value_or("");
  std::vector<std::string> peers;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = std::min(text.find(';', at), text.size());
    if (end > at) peers.push_back(text.substr(at, end - at));
    at = end + 1;
  }
  return peers;
}

RosDistribution read_distribution(const Environment& environment) {
  const std::string text = environment("ROS_DISTRO").value_or("");
  if (text.empty()) return RosDistribution::jazzy;
  const auto distribution = distribution_of(text);
  if (!distribution) {
    throw InputError("ROS_DISTRO", "is '" + text + "', which is not a release of ROS 2",
                     "set a release such as humble or jazzy");
  }
  return *distribution;
}

std::string discovery_settings(const RosNetwork& network) {
  std::vector<std::string> peers = network.peers;
  if (network.range == DiscoveryRange::localhost) peers.insert(peers.begin(), "localhost");
  if (peers.empty()) return "";
  // Unicast discovery tries the ports of the first participant indices.
  std::string xml =
      "<Discovery><ParticipantIndex>auto</ParticipantIndex><MaxAutoParticipantIndex>32"
      "</MaxAutoParticipantIndex><Peers>";
  for (const std::string& peer : peers) xml += "<Peer address=\"" + markup_escaped(peer) + "\"/>";
  return xml + "</Peers></Discovery>";
}

std::string interface_settings(const RosNetwork& network) {
  constexpr const char* kNobodyAsked = "<AllowMulticast>false</AllowMulticast>";
  constexpr const char* kLoopback = "<Interfaces><NetworkInterface address=\"127.0.0.1\"/></Interfaces>";
  switch (network.range) {
    case DiscoveryRange::localhost:
      return std::string("<General>") + kLoopback + kNobodyAsked + "</General>";
    case DiscoveryRange::off:
      return std::string("<General>") + kNobodyAsked + "</General>";
    case DiscoveryRange::subnet:
    case DiscoveryRange::system:
      break;
  }
  return "";
}

}  // namespace

Environment program_environment() {
  return [](const char* name) -> std::optional<std::string> {
    const char* const text = std::getenv(name);
    return text == nullptr ? std::nullopt : std::optional<std::string>(text);
  };
}

std::optional<RosDistribution> distribution_of(std::string_view name) {
  const bool is_name =
      !name.empty() && std::ranges::all_of(name, [](unsigned char letter) { return std::islower(letter) != 0; });
  if (!is_name) return std::nullopt;
  // Release names ascend alphabetically; ids are shorter from Iron on.
  return name < "iron" ? RosDistribution::humble : RosDistribution::jazzy;
}

RosNetwork read_ros_network(const Environment& environment) {
  RosNetwork network;
  network.domain = read_domain(environment);
  network.range = read_range(environment);
  if (network.range != DiscoveryRange::off) network.peers = read_peers(environment);
  network.distribution = read_distribution(environment);
  network.uses_cyclone = environment("RMW_IMPLEMENTATION") == "rmw_cyclonedds_cpp";
  return network;
}

std::string cyclone_settings(const RosNetwork& network, const std::string& own_settings) {
  const std::string found = interface_settings(network) + discovery_settings(network);
  std::string settings = found.empty() ? "" : "<CycloneDDS><Domain>" + found + "</Domain></CycloneDDS>,";
  if (!own_settings.empty()) settings += own_settings + ",";
  // Shared memory needs types of fixed size, which byre's opaque types are not.
  return settings + "<CycloneDDS><Domain><SharedMemory><Enable>false</Enable></SharedMemory></Domain></CycloneDDS>";
}

}  // namespace byre
