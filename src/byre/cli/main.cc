#include "byre/cli/commands.h"
#include "byre/cli/shared/file_arguments.h"
#include "byre/cli/shared/interrupt.h"
#include "byre/input_error.h"

#include <exception>
#include <filesystem>
#include <iostream>
#include <stdexcept>
#include <string>

#include <CLI/CLI.hpp>
#include <malloc.h>

namespace {

using namespace byre::cli;

constexpr const char* kExitCodes =
    "Exit codes: 0 done, 1 failed at work, 2 wrong usage, 3 bad input (a file, a calibration, a recording),\n"
    "130 stopped by Ctrl-C, 143 by SIGTERM, 129 by SIGHUP (the terminal was closed).\n"
    "\"byre COMMAND --help\" explains a command.";

int report(const std::string& message, ExitCode code) {
  std::cerr << "byre: error: " << message << "\n";
  return code;
}

int run(const Action& action, CLI::App& app) {
  try {
    require_files_or_folders(app);
    const ExitCode code = action(std::cout);
    const bool is_told = static_cast<bool>(std::cout.flush());
    if (code == interrupted) return exit_code_of_interrupt();  // who listened may be gone with the terminal
    if (!is_told) throw std::runtime_error("the result cannot be written to the standard output");
    return code;
  } catch (const byre::InputError& error) {
    return report(error.what(), bad_input);
  } catch (const std::filesystem::filesystem_error& error) {  // such as a link that leads round in a circle
    return report(error.path1().string() + ": " + error.code().message(), bad_input);
  } catch (const std::exception& error) {
    return report(error.what(), failed);
  }
}

// What large buffers took goes back to the system when they are freed. By default the allocator keeps the more the
// larger they are, which makes up a tenth of the memory of a run.
void keep_little_memory() {
  mallopt(M_MMAP_THRESHOLD, 1 << 20);
  mallopt(M_TRIM_THRESHOLD, 4 << 20);
}

}  // namespace

int main(int argc, char** argv) {
  keep_little_memory();
  CLI::App app("Visual SLAM for robots that work in the same building every day.", "byre");
  app.set_version_flag("--version", "byre " BYRE_VERSION, "Print the version and exit");
  app.require_subcommand(0, 1);
  app.footer(kExitCodes);
  app.failure_message([](const CLI::App*, const CLI::Error& error) {
    return std::string("byre: error: ") + error.what() + "\n\"byre --help\" and \"byre COMMAND --help\" say more.\n";
  });
  let_writing_fail();
  Action action;
  declare_commands(app, action);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {  // parse errors, and --help and --version, which succeed
    return app.exit(error) == done ? done : wrong_usage;
  } catch (const byre::InputError& error) {  // bad input read by --print-options
    return report(error.what(), bad_input);
  } catch (const std::exception& error) {
    return report(error.what(), failed);
  }
  if (!action) return report("name a command, as \"byre --help\" lists them", wrong_usage);
  return run(action, app);
}
