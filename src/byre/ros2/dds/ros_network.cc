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

using Entry = std::pair<std::string_view, std::string_view>;

constexpr std::array kHashes = {
    Entry{"rmw_dds_common/msg/ParticipantEntitiesInfo",
          "RIHS01_91a0593bacdcc50ea9bdcf849a938b128412cc1ea821245c663bcd26f83c295e"},
    Entry{"sensor_msgs/msg/Image", "RIHS01_d31d41a9a4c4bc8eae9be757b0beed306564f7526c88ea6a4588fb9582527d47"},
    Entry{"sensor_msgs/msg/CompressedImage", "RIHS01_15640771531571185e2efc8a100baf923961a4d15d5569652e6cb6691e8e371a"},
    Entry{"sensor_msgs/msg/CameraInfo", "RIHS01_b3dfd68ff46c9d56c80fd3bd4ed22c7a4ddce8c8348f2f59c299e73118e7e275"},
    Entry{"sensor_msgs/msg/Imu", "RIHS01_7d9a00ff131080897a5ec7e26e315954b8eae3353c3f995c55faf71574000b5b"},
    Entry{"sensor_msgs/msg/PointCloud2", "RIHS01_9198cabf7da3796ae6fe19c4cb3bdd3525492988c70522628af5daa124bae2b5"},
    Entry{"nav_msgs/msg/Odometry", "RIHS01_3cc97dc7fb7502f8714462c526d369e35b603cfc34d946e3f2eda2766dfec6e0"},
    Entry{"nav_msgs/msg/Path", "RIHS01_1957a5bb3cee5da65c4e52e52b65a93df227efce4c20f8458b36e73066ca334b"},
    Entry{"nav_msgs/msg/OccupancyGrid", "RIHS01_8d348150c12913a31ee0ec170fbf25089e4745d17035792a1ba94d6f0bc0cfc7"},
    Entry{"geometry_msgs/msg/PoseWithCovarianceStamped",
          "RIHS01_26432f9803e43727d3c8f668d1fdb3c630f548af631e2f4e31382371bfea3b6e"},
    Entry{"geometry_msgs/msg/TwistStamped", "RIHS01_5f0fcd4f81d5d06ad9b4c4c63e3ea51b82d6ae4d0558f1d475229b1121db6f64"},
    Entry{"geometry_msgs/msg/TwistWithCovarianceStamped",
          "RIHS01_77b67434531e6529b7a0091357b186b6ebdb17fd9ffd3e0c7ce9d3fb11a44563"},
    Entry{"tf2_msgs/msg/TFMessage", "RIHS01_e369d0f05a23ae52508854b66f6aa0437f3449d652e8cbf22d5abe85d020f087"},
    Entry{"diagnostic_msgs/msg/DiagnosticArray",
          "RIHS01_5a8a36efb05fb25070fa0fb3810290c0e6cd4862b54a8fb975a1ee8dc55a333e"},
    Entry{"std_msgs/msg/String", "RIHS01_df668c740482bbd48fb39d76a70dfd4bd59db1288021743503259e948f6b1a18"},
};

bool is_word_letter(char letter) {
  return std::isalnum(static_cast<unsigned char>(letter)) != 0 || letter == '_';
}

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

std::string dds_topic_name(std::string_view topic) {
  return "rt" + std::string(topic);
}

std::string dds_request_name(std::string_view service) {
  return "rq" + std::string(service) + "Request";
}

std::string dds_reply_name(std::string_view service) {
  return "rr" + std::string(service) + "Reply";
}

std::string dds_type_name(std::string_view type_name) {
  std::string name;
  const std::size_t last = type_name.rfind('/');
  for (std::size_t i = 0; i < type_name.size(); ++i) {
    if (type_name[i] != '/') name += type_name[i];
    if (type_name[i] == '/') name += i == last ? "::dds_::" : "::";
  }
  return name + "_";
}

std::string ros_type_name(std::string_view dds_type) {
  constexpr std::string_view kMark = "dds_::";
  const std::size_t mark = dds_type.find(kMark);
  if (mark == std::string_view::npos || !dds_type.ends_with('_')) return "";
  dds_type.remove_suffix(1);
  std::string name = std::string(dds_type.substr(0, mark)) + std::string(dds_type.substr(mark + kMark.size()));
  for (std::size_t at = 0; (at = name.find("::", at)) != std::string::npos;) name.replace(at, 2, "/");
  return name;
}

std::string fault_in_name(std::string_view name) {
  constexpr std::size_t kLongest = 240;  // characters; DDS accepts 256 including prefix and suffix
  if (name.size() > kLongest) return "is longer than 240 characters";
  if (!name.starts_with('/')) return "does not begin with a slash";
  if (name == "/") return "";
  bool is_word_begin = true;
  for (const char letter : name.substr(1)) {
    if (letter == '/' ? is_word_begin : !is_word_letter(letter)) {
      return letter == '/' ? "has two consecutive slashes"
                           : "contains characters other than letters, digits, underscores and slashes";
    }
    if (is_word_begin && std::isdigit(static_cast<unsigned char>(letter)) != 0)
      return "has a part that begins with a digit";
    is_word_begin = letter == '/';
  }
  return is_word_begin ? "ends with a slash" : "";
}

std::string resolve_name(std::string_view topic, std::string_view name_space) {
  if (topic.starts_with('/')) return std::string(topic);
  return std::string(name_space) + (name_space.ends_with('/') ? "" : "/") + std::string(topic);
}

std::string_view type_hash(std::string_view type_name) {
  const auto* const found = std::ranges::find(kHashes, type_name, &Entry::first);
  return found == kHashes.end() ? std::string_view() : found->second;
}

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
