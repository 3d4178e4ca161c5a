#pragma once

#include "byre/slam/system/slam_impl.h"

#include <filesystem>
#include <string>

namespace byre {

// Sets the options in a YAML file (docs/reference/options.md); others are unchanged. Throws InputError with the line
// for an unknown option or an invalid value.
void read_options(const std::filesystem::path& path, MethodOptions& options);

// File for read_options with all options, their meanings, units and ranges.
std::string options_file(const MethodOptions& options);

}  // namespace byre
