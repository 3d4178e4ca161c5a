#pragma once

#include "byre/slam/system/engine.h"

#include <filesystem>
#include <functional>
#include <optional>

namespace CLI {
class App;
}

namespace byre::cli {

// Value of --options.
using OptionsFile = std::optional<std::filesystem::path>;

// Default options, modified by the file.
EngineOptions read_engine_options(const OptionsFile& file);

// --options and --print-options, which prints the result of used() and ends the program. Declare them after the options
// that used() reads. All must outlive the parsing of the command line.
void declare_options_file(CLI::App& command, OptionsFile& file, std::function<EngineOptions()> used);

}  // namespace byre::cli
