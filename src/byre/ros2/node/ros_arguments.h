#pragma once

#include "byre/ros2/node/node_config.h"
#include "byre/ros2/node/process.h"

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace byre {

// Command-line arguments of ROS 2 (--ros-args) that the node accepts.
struct RosArguments {
  std::vector<std::string> remaps{};      // "FROM:=TO" of topics; "__node:=NAME", "__ns:=/NAMESPACE"
  std::vector<std::string> parameters{};  // "NAME:=VALUE", named as the settings: "slam.map:=barn.byre"
  std::vector<std::string> parameter_files{};

  bool empty() const { return remaps.empty() && parameters.empty() && parameter_files.empty(); }
};

// Settings of a file, if any, then of the parameter files, of the parameters, and of the remaps; later ones replace
// earlier ones. Faults include unknown parameters, and remaps of names that are no topic of the node. Relative paths
// start at the folder of their file; those of parameters at the working directory.
NodeConfigReading read_node_config(const std::optional<std::filesystem::path>& path, const RosArguments& arguments);

// Least severe level that is logged: debug and info all, warn, error and fatal errors; upper or lower case, perhaps
// after the name of a logger, which must be the node. Empty if invalid.
std::optional<LogLevel> log_level_of(std::string_view text, const std::string& node_name);

}  // namespace byre
