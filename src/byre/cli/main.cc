#include "byre/base/printable.h"
#include "byre/cli/commands.h"
#include "byre/cli/shared/arguments.h"
#include "byre/cli/shared/options.h"
#include "byre/cli/shared/progress.h"
#include "byre/input_error.h"

#include <exception>
#include <filesystem>
#include <iostream>
#include <new>
#include <string>
#include <system_error>
#include <vector>

#include <CLI/CLI.hpp>
#include <malloc.h>
#include <poll.h>
#include <unistd.h>

namespace {

using namespace byre::cli;

constexpr const char* kExitCodes =
    "Exit codes: 0 done, 1 failed at work, 2 wrong usage, 3 bad input (a file, a calibration, a recording),\n"
    "130 stopped by Ctrl-C, 143 by SIGTERM, 129 by SIGHUP (the terminal was closed).\n"
    "\"byre COMMAND --help\" explains a command.";

constexpr const char* kUnwritten =
    "standard output: cannot be written (free disk space, or redirect it to another file)";

int report(const std::string& message, ExitCode code) {
  std::cerr << "byre: error: " << byre::printable(message) << "\n";
  return code;
}

// The reader of a pipe may end early, as in "byre map --help | head". That is no error worth a message.
int report_unwritten() {
  pollfd output{.fd = STDOUT_FILENO, .events = 0, .revents = 0};
  const bool has_reader_ended = poll(&output, 1, 0) == 1 && (output.revents & POLLERR) != 0;
  return has_reader_ended ? static_cast<int>(failed) : report(kUnwritten, failed);
}

int run(const Action& action, CLI::App& app) {
  try {
    require_files_or_folders(app);
    const ExitCode code = action(std::cout);
    const bool is_written = static_cast<bool>(std::cout.flush());
    if (code == interrupted) return exit_code_of_interrupt();  // the reader may have ended with the terminal
    return is_written ? static_cast<int>(code) : report_unwritten();
  } catch (const byre::InputError& error) {
    return report(error.what(), bad_input);
  } catch (const std::filesystem::filesystem_error& error) {  // such as a cyclic link
    return report(error.path1().string() + ": " + error.code().message(), bad_input);
  } catch (const std::bad_alloc&) {
    return report("out of memory (free memory, or raise the limit that \"ulimit -v\" shows)", failed);
  } catch (const std::system_error& error) {
    if (error.code() != std::errc::resource_unavailable_try_again) return report(error.what(), failed);
    return report("a thread cannot be started: " + error.code().message() +
                      " (free memory, or raise the limits that \"ulimit -v\" and \"ulimit -u\" show)",
                  failed);
  } catch (const std::exception& error) {
    return report(error.what(), failed);
  }
}

// Returns large freed buffers to the system. By default the allocator raises its thresholds with the buffer size, which
// costs a tenth of the memory of a run.
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
  std::vector<std::string> arguments;
  app.failure_message([&arguments](const CLI::App* failed, const CLI::Error& error) {
    const std::string unknown = unknown_argument(*failed, arguments);
    return "byre: error: " + byre::printable(unknown.empty() ? error.what() : unknown) +
           "\nSee \"byre --help\" and \"byre COMMAND --help\".\n";
  });
  ignore_write_signals();
  Action action;
  declare_commands(app, action);
  try {
    arguments = with_right_calibration({argv + 1, argv + argc});
    app.parse(std::vector<std::string>(arguments.rbegin(), arguments.rend()));  // reversed, as CLI11 takes them
  } catch (const CLI::ParseError& error) {  // parse errors; also --help and --version, which succeed
    if (app.exit(error) != done) return wrong_usage;
    return std::cout.flush() ? static_cast<int>(done) : report_unwritten();
  } catch (const byre::InputError& error) {  // bad input read by --print-options
    return report(error.what(), bad_input);
  } catch (const std::exception& error) {
    return report(error.what(), failed);
  }
  if (!action) return report("give a command, see \"byre --help\"", wrong_usage);
  return run(action, app);
}
