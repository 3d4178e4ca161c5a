#pragma once

#include "byre/system/engine.h"

#include <filesystem>
#include <functional>
#include <optional>

namespace CLI {
class App;
}

namespace byre::cli {

// What --options names.
using OptionsFile = std::optional<std::filesystem::path>;

// The defaults, changed by that file.
EngineOptions read_engine_options(const OptionsFile& file);

// --options and --print-options, which prints what used gives and ends the program. Declare them after all that used
// asks for. All must outlive the parsing of the command line.
void declare_options_file(CLI::App& command, OptionsFile& file, std::function<EngineOptions()> used);

}  // namespace byre::cli
