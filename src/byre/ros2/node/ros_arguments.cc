#include "byre/ros2/node/ros_arguments.h"

#include "byre/base/text_file.h"
#include "byre/ros2/dds/ros_network.h"

#include <algorithm>
#include <array>
#include <utility>

namespace byre {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kAssign = ":=";
constexpr std::string_view kUseSimTime = "use_sim_time";  // without effect: stamps are those of the images

struct Assignment {
  std::string node;  // node in front of the name; empty: every node
  std::string name;
  std::string value;
};

// Parts of "NODE:NAME:=VALUE"; empty if it is none.
std::optional<Assignment> assignment_of(const std::string& text) {
  const std::size_t assign = text.find(kAssign);
  if (assign == std::string::npos) return std::nullopt;
  Assignment parts{"", text.substr(0, assign), text.substr(assign + kAssign.size())};
  if (const std::size_t colon = parts.name.find(':'); colon != std::string::npos) {
    parts.node = parts.name.substr(0, colon);
    parts.name.erase(0, colon + 1);
  }
  return parts.name.empty() ? std::nullopt : std::optional(parts);
}

// Parts of an argument for this node, else a fault.
std::optional<Assignment> own_assignment(const std::string& option, const std::string& text, const std::string& node,
                                         std::vector<InputError>& faults) {
  auto parts = assignment_of(text);
  if (!parts) faults.emplace_back(option + " " + text, "has no :=", "write NAME:=VALUE");
  if (parts && !parts->node.empty() && parts->node != node) {
    faults.emplace_back(option + " " + text, "is for the node " + parts->node + ", but this one is " + node,
                        "leave the name of the node out");
    return std::nullopt;
  }
  return parts;
}

// Name in a remap, in full, by the rules of ROS: "~/" begins in the node, other relative names in its namespace.
std::string full_name_of(const std::string& name, const NodeConfig& config) {
  if (name.starts_with("~/")) return config.full_name() + name.substr(1);
  return resolve_name(name, config.name_space.empty() ? "/" : config.name_space);
}

bool is_topic_setting(const NodeSetting& setting) {
  return setting.range.starts_with("topic") && setting.name != "node.namespace";
}

// Whether a key of a parameter file names the node: "byre", "/robot1/byre", "/**", "/**/byre", also as nested groups.
bool names_node(std::string key, const std::string& full_name) {
  constexpr std::string_view kAny = "/**";
  std::ranges::replace(key, '.', '/');
  if (!key.starts_with('/')) key.insert(0, "/");
  return key.starts_with(kAny) ? full_name.ends_with(key.substr(kAny.size())) : key == full_name;
}

// Adds the parameters of the node. Throws InputError if the file has none.
void add_file(const fs::path& path, const std::string& full_name, std::vector<GivenSetting>& given) {
  constexpr std::string_view kMark = ".ros__parameters.";
  bool is_named = false;
  for (GivenSetting& setting : settings_of_file(path)) {
    const std::size_t mark = setting.name.find(kMark);
    if (mark == std::string::npos) {
      throw InputError(setting.place, setting.name + " is not within ros__parameters of a node",
                       "write it below /**: ros__parameters:, or give the file with --config");
    }
    if (!names_node(setting.name.substr(0, mark), full_name)) continue;
    is_named = true;
    setting.name.erase(0, mark + kMark.size());
    if (setting.name != kUseSimTime) given.push_back(std::move(setting));
  }
  if (is_named) return;
  throw InputError(path.string(), "has no parameters of the node " + full_name, "write them below " + full_name + ":");
}

void remap(const Assignment& parts, const std::string& place, NodeConfigReading& reading) {
  NodeConfig& config = reading.config;
  const std::string from = full_name_of(parts.name, config), to = full_name_of(parts.value, config);
  std::string topics;
  bool is_found = false;
  const NodeConfig before = config;
  for (const NodeSetting& setting : node_settings()) {
    if (!is_topic_setting(setting) || setting.get(before).empty()) continue;
    const std::string topic = config.topic(setting.get(before));
    topics += (topics.empty() ? "" : ", ") + topic;
    if (topic != from) continue;
    is_found = true;
    if (!setting.set(config, to)) reading.faults.emplace_back(place, "'" + to + "' is not a topic", "give a topic");
  }
  if (!is_found) reading.faults.emplace_back(place, from + " is not a topic of the node", "give one of " + topics);
}

}  // namespace

NodeConfigReading read_node_config(const std::optional<fs::path>& path, const RosArguments& arguments) {
  constexpr std::string_view kNode = "__node", kOldNode = "__name", kNamespace = "__ns";
  std::vector<GivenSetting> given;
  if (path) given = settings_of_file(*path);
  NodeConfig named = config_of(given).config;
  std::vector<InputError> faults;
  std::vector<GivenSetting> names;
  std::vector<std::pair<Assignment, std::string>> topics;
  for (const std::string& text : arguments.remaps) {
    const auto parts = own_assignment("-r", text, named.name, faults);
    if (!parts) continue;
    const bool is_node = parts->name == kNode || parts->name == kOldNode;
    if (is_node) named.name = parts->value;
    if (parts->name == kNamespace) named.name_space = parts->value;
    if (is_node || parts->name == kNamespace) {
      names.push_back({is_node ? "node.name" : "node.namespace", parts->value, "-r " + text, ""});
    } else {
      topics.emplace_back(*parts, "-r " + text);
    }
  }
  for (const std::string& file : arguments.parameter_files) add_file(file, named.full_name(), given);
  for (const std::string& text : arguments.parameters) {
    const auto parts = own_assignment("-p", text, named.name, faults);
    if (parts && parts->name != kUseSimTime) given.push_back({parts->name, parts->value, "-p " + text, ""});
  }
  given.insert(given.end(), names.begin(), names.end());
  NodeConfigReading reading = config_of(given);
  if (path) reading.config.file = without_tilde(*path);
  reading.faults.insert(reading.faults.begin(), faults.begin(), faults.end());
  for (const auto& [parts, place] : topics) remap(parts, place, reading);
  complete(reading, given, path ? path->string() : "byre node");
  return reading;
}

std::optional<LogLevel> log_level_of(std::string_view text, const std::string& node_name) {
  constexpr std::array<std::pair<std::string_view, LogLevel>, 5> kLevels = {{{"debug", LogLevel::info},
                                                                             {"info", LogLevel::info},
                                                                             {"warn", LogLevel::warning},
                                                                             {"error", LogLevel::error},
                                                                             {"fatal", LogLevel::error}}};
  if (const std::size_t assign = text.find(kAssign); assign != std::string_view::npos) {
    if (text.substr(0, assign) != node_name) return std::nullopt;
    text.remove_prefix(assign + kAssign.size());
  }
  const std::string level = lower_case(text);
  const auto* const found = std::ranges::find(kLevels, level, &std::pair<std::string_view, LogLevel>::first);
  return found == kLevels.end() ? std::nullopt : std::optional(found->second);
}

}  // namespace byre
