#include "byre/cli/shared/options_file.h"

#include "byre/cli/shared/file_arguments.h"
#include "byre/playback/options_file.h"

#include <iostream>
#include <stdexcept>
#include <utility>

#include <CLI/CLI.hpp>

namespace byre::cli {

EngineOptions read_engine_options(const OptionsFile& file) {
  EngineOptions options;
  if (file) read_options(*file, options);
  return options;
}

void declare_options_file(CLI::App& command, OptionsFile& file, std::function<EngineOptions()> used) {
  add_input(command, Input::file, "--options", file,
            "Options of the method as printed by --print-options; command line options win over the file")
      ->type_name("YAML");
  const auto print = [used = std::move(used)] {
    std::cout << options_file(used()) << std::flush;
    if (!std::cout) throw std::runtime_error("the options cannot be written to the standard output");
    throw CLI::Success();
  };
  command.add_flag_callback("--print-options", print, "Print the resulting values of all options as YAML, and exit");
}

}  // namespace byre::cli
