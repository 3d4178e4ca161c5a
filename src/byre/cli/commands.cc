#include "byre/cli/commands.h"

#include "byre/cli/shared/file_arguments.h"

#include <algorithm>
#include <array>

#include <CLI/CLI.hpp>

namespace byre::cli {
namespace {

struct Command {
  const char* name;
  const char* summary;
  Action (*declare)(CLI::App& command);
};

constexpr std::array kCommands = {
    Command{"demo", "Show all of it on a simulated cowshed, as a page to look at", declare_demo},
    Command{"check", "Say what of a recording would spoil a mission, and what to do about it", declare_check},
    Command{"bag", "Tell what a bag of ROS holds", declare_bag},
    Command{"camera", "Tell which cameras there are, look at what they give, record them", declare_camera},
    Command{"map", "Turn a recording into a map and a trajectory", declare_map},
    Command{"run", "Run a mission on a map: track, map what is new, say how far to trust it", declare_run},
#ifdef BYRE_WITH_NODE
    Command{"node", "Track what topics of ROS 2 bring, and publish poses and health there", declare_node},
#endif
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
    Command{"completion", "Print the script by which a shell completes byre's commands", declare_completion},
};

bool writes_files(CLI::App& command) {
  return std::ranges::any_of(command.get_options(), [](CLI::Option* option) { return output_of(*option).has_value(); });
}

}  // namespace

void declare_commands(CLI::App& app, Action& action) {
  declare_no_overwrite(app);
  for (const Command& command : kCommands) {
    CLI::App* const declared = app.add_subcommand(command.name, command.summary);
    check_when_parsed(*declared);  // a command's own check replaces it
    declared->callback([&action, run = command.declare(*declared)] { action = run; });
    std::vector<CLI::App*> writing = declared->get_subcommands([](CLI::App*) { return true; });
    writing.push_back(declared);
    for (CLI::App* const each : writing) {
      if (writes_files(*each)) declare_no_overwrite(*each);
    }
  }
}

}  // namespace byre::cli
