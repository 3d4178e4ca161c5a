#pragma once

#include <filesystem>

#include <yaml-cpp/yaml.h>

namespace byre {

// Reads a YAML file of named fields. Throws InputError for a file that is missing, a pipe, invalid, or another
// document.
YAML::Node load_yaml_mapping(const std::filesystem::path& path);

}  // namespace byre
