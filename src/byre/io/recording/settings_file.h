#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace byre {

struct Setting {
  std::string name;  // full name: names of its groups and its own, separated by dots
  std::string text;
  int line = 0;  // from 1
};

// The settings of a YAML file of named groups, in the order of the file. Throws InputError if it cannot be read, has
// another structure, or names a setting twice.
std::vector<Setting> read_settings(const std::filesystem::path& path);

}  // namespace byre
