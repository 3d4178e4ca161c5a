#include "byre/cli/commands.h"

#include "byre/cli/shared/arguments.h"

#include <algorithm>
#include <array>
#include <memory>

#include <CLI/CLI.hpp>

namespace byre::cli {
namespace {

constexpr std::array kCommands = {
    Command{"demo", "Demonstrate byre on a simulated cowshed, as an HTML page", declare_demo},
    Command{"check", "Check a recording for problems, with remedies", declare_check},
    Command{"bag", "Print the contents of a ROS bag", declare_bag},
    Command{"camera", "List, examine and record cameras", declare_camera},
    Command{"map", "Make a map and a trajectory of a recording", declare_map},
    Command{"run", "Run a mission on a map: track, map changes, rate each pose", declare_run},
    Command{"node", "Run the ROS 2 node: track images, publish poses and health", declare_node},
    Command{"registry", "Exchange maps and sessions of many sites by a PostgreSQL database", declare_registry},
    Command{"worker", "Run the jobs of a registry: updates and merges", declare_worker},
    Command{"localise", "Localise frames in a map, each without prediction", declare_localise, "localize"},
    Command{"register", "Register a map on a floor plan", declare_register},
    Command{"refine", "Close further loops of a map and adjust it as a whole", declare_refine},
    Command{"update", "Update a map by sessions of missions, if it gets no worse anywhere", declare_update},
    Command{"history", "Print the updates that a map was made by", declare_history},
    Command{"diff", "Compare the points and keyframes of two versions of a map", declare_diff},
    Command{"merge", "Merge two maps that overlap", declare_merge},
    Command{"cut", "Remove a region from a map, or all but a region", declare_cut},
    Command{"calibrate", "Refine the calibration of a recording's cameras by its images", declare_calibrate},
    Command{"calibration", "Show or convert a calibration file of any format", declare_calibration},
    Command{"scale", "Scale a monocular map by a known distance", declare_scale},
    Command{"draw", "Draw a map on its floor plan, camera images and videos of missions", declare_draw},
    Command{"view", "Show a map in a browser, and register it on a floor plan", declare_view},
    Command{"inspect", "Print the contents and residuals of a map", declare_inspect, "info"},
    Command{"validate", "Check the consistency of a map", declare_validate},
    Command{"evaluate", "Compare an estimated trajectory with the truth", declare_evaluate, "eval"},
    Command{"benchmark", "Measure accuracy and speed on a protocol of recordings", declare_benchmark, "bench"},
    Command{"vocabulary", "Train, import or show a visual vocabulary", declare_vocabulary},
    Command{"simulate", "Render a recording of a simulated barn, with truth and floor plan", declare_simulate},
    Command{"import-colmap", "Import a COLMAP model and its images as a map", declare_import_colmap},
    Command{"export-colmap", "Export a map as a COLMAP model", declare_export_colmap},
    Command{"completion", "Print the completion script of a shell", declare_completion},
};

bool writes_files(CLI::App& command) {
  return std::ranges::any_of(command.get_options(), [](CLI::Option* option) { return output_of(*option).has_value(); });
}

}  // namespace

void declare_commands(CLI::App& app, Action& action) {
  declare_no_overwrite(app);
  for (const Command& command : kCommands) {
    CLI::App* const declared = app.add_subcommand(command.name, command.summary);
    if (command.alias != nullptr) declared->alias(command.alias);
    check_when_parsed(*declared);  // a command's own check replaces it
    declared->callback([&action, run = command.declare(*declared)] { action = run; });
    std::vector<CLI::App*> writing = declared->get_subcommands([](CLI::App*) { return true; });
    writing.push_back(declared);
    for (CLI::App* const each : writing) {
      if (writes_files(*each)) declare_no_overwrite(*each);
    }
  }
}

Action declare_subcommands(CLI::App& command, std::initializer_list<Command> subcommands) {
  const auto chosen = std::make_shared<Action>();
  command.require_subcommand(1);
  for (const Command& each : subcommands) {
    CLI::App* const declared = command.add_subcommand(each.name, each.summary);
    declared->callback([chosen, run = each.declare(*declared)] { *chosen = run; });
  }
  return [chosen](std::ostream& result) { return (*chosen)(result); };
}

}  // namespace byre::cli
