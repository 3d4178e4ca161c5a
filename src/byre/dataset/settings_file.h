#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace byre {

// A named word of a YAML file.
struct Setting {
  std::string name;  // full name: the groups that it is in, then its own, with dots between
  std::string text;
  int line = 0;  // as an editor counts them, from 1
};

// The words of a YAML file of named groups, in the order of the file. Throws InputError when it cannot be read, is no
// such file, or names a setting twice.
std::vector<Setting> read_settings(const std::filesystem::path& path);

}  // namespace byre
