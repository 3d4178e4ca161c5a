#include "byre/cli/view_run.h"

#include "byre/cli/pose_frame.h"
#include "byre/map/driving_plane.h"

#include <chrono>
#include <iostream>
#include <thread>
#include <utility>

namespace byre::cli {
namespace {

RunDescription describe(const ViewOptions& options, const WatchedRun& run) {
  RunDescription description;
  description.name = std::filesystem::absolute(run.recording).lexically_normal().filename().string();
  description.calibration = run.opened.calibration();
  description.frames = run.opened.size();
  description.last_time = run.opened.times().back();
  if (run.map) {
    description.map_name = run.map->filename().string();
    description.offline = scene_of({&run.offline->map(), Map(Origin::online)});
    if (const auto plane = fit_driving_plane(run.offline->map())) description.up_in_map = plane->up_in_map;
  }
  if (options.plan) {
    description.plan = read_floor_plan(*options.plan);
    description.registration = require_plan(load_plan_registration(*run.map), *run.map);
  }
  return description;
}

}  // namespace

std::unique_ptr<RunViewer> start_viewer(const ViewOptions& options, const WatchedRun& run) {
  RunViewerOptions viewer_options;
  viewer_options.server = options.server;
  auto viewer = std::make_unique<RunViewer>(describe(options, run), viewer_options);
  std::cerr << "viewer: " << viewer->url() << std::endl;
  return viewer;
}

std::function<void(const RunView& view)> shown_in(RunViewer& viewer) {
  return [&viewer](const RunView& view) { viewer.show(view.images.left, *view.frame.report, view.session); };
}

void serve_until_interrupted(const InterruptCatcher& interrupt, bool quiet) {
  if (!quiet) std::cerr << "viewer: goes on until Ctrl-C" << std::endl;
  while (!interrupt.caught()) std::this_thread::sleep_for(std::chrono::milliseconds(50));
}

}  // namespace byre::cli
