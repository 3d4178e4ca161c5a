#include "byre/cli/shared/view_run.h"

#include "byre/base/stopwatch.h"
#include "byre/cli/shared/arguments.h"
#include "byre/cli/shared/options.h"
#include "byre/map/plan/driving_plane.h"
#include "byre/map/stored_calibration.h"
#include "byre/slam/system/resources.h"

#include <chrono>
#include <iostream>
#include <limits>
#include <thread>

#include <CLI/CLI.hpp>
#include <fmt/core.h>
#include <unistd.h>

namespace byre::cli {
namespace {

CLI::Option* declare_port(CLI::App& command, const std::string& name, int& port, const std::string& what) {
  return command.add_option(name, port, what + " (" + std::to_string(port) + "; 0: any free port)")
      ->type_name("PORT")
      ->check(between(0, 65535));
}

CLI::Option* declare_address(CLI::App& command, ViewOptions& options) {
  return add_text(command, "--bind", options.server.address,
                  "Network address to serve at, 0.0.0.0 for all; clients need the token in the printed address "
                  "(127.0.0.1: only this machine, no token)")
      ->type_name("ADDRESS");
}

CLI::Option* declare_plan(CLI::App& command, ViewOptions& options, const std::string& what) {
  return add_input(command, Input::plan, "--plan", options.plan, what);
}

RunDescription describe(const ViewOptions& options, const WatchedRun& run) {
  RunDescription description;
  description.name = run.name;
  description.calibration = run.calibration;
  description.frames = run.frames;
  description.last_time = run.last_time;
  if (run.map) {
    description.map_name = run.map->filename().string();
    description.offline = scene_of({&run.offline->map(), MapGraph(Origin::online)});
    if (const auto plane =
            fit_driving_plane(run.offline->map(), up_of_base(run.offline->extrinsics(), run.offline->recordings())))
      description.up_in_map = plane->up_in_map;
  }
  if (options.plan) {
    description.plan = read_floor_plan(*options.plan);
    description.registration = require_plan(load_plan_registration(*run.map), *run.map);
  }
  return description;
}

// Whether a user can end the program.
bool has_terminal() {
  return isatty(STDIN_FILENO) != 0 || isatty(STDOUT_FILENO) != 0;
}

RunViewer start_viewer(const ViewOptions& options, const WatchedRun& run) {
  RunViewerOptions viewer_options;
  viewer_options.server = options.server;
  raise_descriptor_limit();
  return RunViewer(describe(options, run), viewer_options);
}

std::string describe_stay(double stay_s, bool is_asked_for) {
  if (stay_s == std::numeric_limits<double>::infinity()) return "stays until Ctrl-C";
  if (stay_s > 0.0) return fmt::format("stays for {:g} s, or until Ctrl-C", stay_s);
  return is_asked_for ? "ends with the run"
                      : "ends with the run, as there is no terminal (to keep it: --view-for SECONDS)";
}

}  // namespace

void declare_run_viewer_options(CLI::App& command, ViewOptions& options) {
  CLI::Option* const view =
      declare_port(command, "--view", options.server.port, "Show the run in a browser, served at this port")
          ->expected(0, 1)
          ->default_str(std::to_string(options.server.port));
  view->each([&options](const std::string&) { options.is_wanted = true; });
  command
      .add_option("--view-for", options.stay_s,
                  "Time to serve the page after the end of the run (until Ctrl-C with a terminal, else 0)")
      ->type_name("SECONDS")
      ->check(between(0.0, 1e9))
      ->needs(view);
  declare_address(command, options)->needs(view);
  declare_plan(command, options,
               "Floor plan on which \"byre register\" registered the map: poses behind its walls are rejected, and "
               "--view shows it below the map");
}

void declare_viewer_options(CLI::App& command, ViewOptions& options, const std::string& plan) {
  options.is_wanted = true;
  declare_port(command, "--port", options.server.port, "Port to serve the page at");
  declare_address(command, options);
  declare_plan(command, options, plan + ": a map_server YAML file, or an image with a world file");
}

WatchedRunViewer::WatchedRunViewer(const ViewOptions& options, const WatchedRun& run)
    : viewer_(start_viewer(options, run)),
      messages_(viewer_.messages(), run.calibration, {.with_images = true, .is_watched = true}) {
  announce(viewer_.urls());
}

void WatchedRunViewer::note(const RunView& view) {
  messages_.note(view);
  viewer_.show(view.images.left, *view.frame.report, view.session);
}

void WatchedRunViewer::note_unreadable(const PlayedFrame& frame) {
  messages_.note_unreadable(frame);
}

void WatchedRunViewer::finish(const RunResult& run) {
  messages_.finish(run);
  viewer_.end_run();
}

void announce(const std::vector<std::string>& urls) {
  for (const std::string& url : urls) std::cerr << "viewer: " << url << "\n";
  std::cerr << std::flush;
}

void serve_until_interrupted(const InterruptCatcher& interrupt, bool quiet) {
  ViewOptions options;
  options.stay_s = std::numeric_limits<double>::infinity();
  serve_after_run(options, interrupt, quiet);
}

void serve_after_run(const ViewOptions& options, const InterruptCatcher& interrupt, bool quiet) {
  const double stay_s = options.stay_s.value_or(has_terminal() ? std::numeric_limits<double>::infinity() : 0.0);
  if (!quiet) std::cerr << "viewer: " << describe_stay(stay_s, options.stay_s.has_value()) << std::endl;
  const Stopwatch watch;
  while (!interrupt.caught() && watch.seconds() < stay_s) std::this_thread::sleep_for(std::chrono::milliseconds(50));
}

}  // namespace byre::cli
