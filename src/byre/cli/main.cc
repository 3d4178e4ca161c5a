#include "byre/cli/commands.h"
#include "byre/input/input_error.h"

#include <array>
#include <exception>
#include <iostream>
#include <stdexcept>
#include <string>

#include <CLI/CLI.hpp>

namespace {

using namespace byre::cli;

constexpr const char* kExitCodes =
    "Exit codes: 0 done, 1 failed at work, 2 wrong usage, 3 bad input (a file, a calibration, a recording),\n"
    "130 stopped by Ctrl-C.\n"
    "\"byre COMMAND --help\" explains a command.";

struct Command {
  const char* name;
  const char* summary;
  Action (*declare)(CLI::App& command);
};

constexpr std::array kCommands = {
    Command{"demo", "Show all of it on a simulated cowshed, as a page to look at", declare_demo},
    Command{"check", "Say what of a recording would spoil a mission, and what to do about it", declare_check},
    Command{"map", "Turn a recording into a map and a trajectory", declare_map},
    Command{"run", "Run a mission on a map: track, map what is new, say how far to trust it", declare_run},
    Command{"localise", "Find frames in a map, each without a guess", declare_localise},
    Command{"register", "Find where a map lies on a floor plan", declare_register},
    Command{"refine", "Look for loops in a map once more and adjust all of it", declare_refine},
    Command{"calibrate", "Refine the calibration of a recording's cameras by what they see", declare_calibrate},
    Command{"scale", "Give the map of one camera its size, by a distance that is known", declare_scale},
    Command{"draw", "Draw a map on its floor plan, what the camera saw, and videos of missions", declare_draw},
    Command{"view", "Show a map in a browser, and find it on a floor plan there", declare_view},
    Command{"inspect", "Tell what a map holds and how well it fits", declare_inspect},
    Command{"validate", "Check that a map is sound", declare_validate},
    Command{"evaluate", "Compare an estimated trajectory with the truth", declare_evaluate},
    Command{"benchmark", "Run a protocol of recordings, and tell how accurate and fast each way to run them is",
            declare_benchmark},
    Command{"vocabulary", "Train, import or show a visual vocabulary", declare_vocabulary},
    Command{"simulate", "Render a recording of a made-up barn, with its truth and floor plan", declare_simulate},
    Command{"import-colmap", "Make a map of a COLMAP model and its images", declare_import_colmap},
    Command{"export-colmap", "Write a map as a COLMAP model", declare_export_colmap},
};

// Declares all commands; the one on the command line becomes the action when that is parsed.
void declare_commands(CLI::App& app, Action& action) {
  for (const Command& command : kCommands) {
    CLI::App* const declared = app.add_subcommand(command.name, command.summary);
    declared->callback([&action, run = command.declare(*declared)] { action = run; });
  }
}

int report(const std::string& message, ExitCode code) {
  std::cerr << "byre: error: " << message << "\n";
  return code;
}

int run(const Action& action) {
  try {
    const ExitCode code = action(std::cout);
    if (!std::cout.flush()) throw std::runtime_error("the result cannot be written to the standard output");
    return code;
  } catch (const byre::InputError& error) {
    return report(error.what(), bad_input);
  } catch (const std::exception& error) {
    return report(error.what(), failed);
  }
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("Visual SLAM for robots that work in the same building every day.", "byre");
  app.set_version_flag("--version", "byre " BYRE_VERSION, "Print the version and exit");
  app.require_subcommand(0, 1);
  app.footer(kExitCodes);
  app.failure_message([](const CLI::App*, const CLI::Error& error) {
    return std::string("byre: error: ") + error.what() + "\n\"byre --help\" and \"byre COMMAND --help\" say more.\n";
  });
  Action action;
  declare_commands(app, action);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {  // also --help and --version, which succeed
    return app.exit(error) == done ? done : wrong_usage;
  }
  if (!action) return report("name a command, as \"byre --help\" lists them", wrong_usage);
  return run(action);
}
