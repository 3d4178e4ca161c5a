#pragma once

#include "byre/system/engine.h"

#include <filesystem>
#include <string>

namespace byre {

// Sets what a YAML file names (docs/options.md); all else stays. Throws InputError, with the line, for what is no
// option, or no value of one.
void read_options(const std::filesystem::path& path, EngineOptions& options);

// All options as a file that read_options takes back, each with its meaning, unit and range.
std::string options_file(const EngineOptions& options);

}  // namespace byre
