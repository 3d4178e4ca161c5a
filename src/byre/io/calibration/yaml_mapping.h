#pragma once

#include <filesystem>
#include <span>
#include <string>

#include <yaml-cpp/yaml.h>

namespace byre {

// Reads a YAML file. Throws InputError for a file that is missing, a folder, a pipe or invalid.
YAML::Node load_yaml(const std::filesystem::path& path);
// Same for a file of named fields. Throws InputError for another document too.
YAML::Node load_yaml_mapping(const std::filesystem::path& path);

// place: of the fields, for InputError. Throws it for a node without named fields, or with a field that is not known.
// of: what the fields describe, such as "tags".
void require_known_fields(const YAML::Node& fields, std::span<const char* const> known, const std::string& place,
                          const char* of);

// Throws InputError unless the node is a number from low to high.
double checked_number(const YAML::Node& node, const std::string& place, double low, double high);

}  // namespace byre
