#pragma once

#include "byre/slam/system/engine.h"

#include <filesystem>
#include <string>

namespace byre {

// Sets the options in a YAML file (docs/reference/options.md); others are unchanged. Throws InputError with the line
// for an unknown option or an invalid value.
void read_options(const std::filesystem::path& path, EngineOptions& options);

// File for read_options with all options, their meanings, units and ranges.
std::string options_file(const EngineOptions& options);

}  // namespace byre
