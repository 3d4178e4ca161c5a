#include "byre/base/output_file.h"
#include "byre/base/report_row.h"
#include "byre/cli/commands.h"
#include "byre/cli/draw/mission.h"
#include "byre/cli/draw/options.h"
#include "byre/cli/shared/warnings.h"
#include "byre/input_error.h"
#include "byre/io/image/plan_file.h"
#include "byre/io/recording/trajectory_input.h"
#include "byre/map/plan/occupancy_grid.h"
#include "byre/map/stored_calibration.h"
#include "byre/slam/system/stored_map.h"
#include "byre/viewer/camera_picture.h"
#include "byre/viewer/mission_input.h"

#include <algorithm>
#include <iostream>
#include <iterator>
#include <memory>
#include <stdexcept>
#include <string>
#include <utility>

#include <fmt/core.h>

namespace byre::cli {
namespace {

namespace fs = std::filesystem;

StoredMap load_map_to_draw(const DrawOptions& options) {
  StoredMap stored = load_map(options.map_file());
  if (stored.map.keyframe_count() == 0) {
    throw InputError(options.map_file().string(), "contains no keyframes, so there is nothing to draw",
                     "map a recording first");
  }
  if (options.plan && !stored.plan) {
    throw InputError(options.map_file().string(), "is not registered on a floor plan, so it cannot be drawn on one",
                     "see \"byre register\"");
  }
  if (options.map && stored.scale != MapScale::metric) {
    throw InputError(options.map_file().string(), "has no metric scale, which missions need", "set it with byre scale");
  }
  if (options.grid && stored.scale != MapScale::metric && !stored.plan) {
    throw InputError(options.map_file().string(), "has no metric scale, which occupancy grids need",
                     "set it with byre scale or byre register");
  }
  return stored;
}

PlanScene scene_without_mission(const DrawOptions& options, const StoredMap& stored) {
  PlanScene scene;
  scene.title = options.map_file().stem().string();
  const std::optional<FloorPlan> plan = options.plan ? std::optional(read_floor_plan(*options.plan)) : std::nullopt;
  scene.ground = ground_of(stored, plan);
  scene.map = scene_of(stored.map);
  for (const fs::path& file : options.trajectories) {
    scene.paths.push_back({file.stem().string(), load_trajectory(file, {}), {}});
  }
  for (const fs::path& file : options.missions) {
    scene.paths.push_back(load_mission(file));
    if (options.missions.size() > 1) scene.paths.back().name = file.stem().string();
  }
  return scene;
}

double share_of(const OccupancyGrid& grid, std::int8_t occupancy) {
  const auto count = std::ranges::count(grid.occupancy, occupancy);
  return 100.0 * static_cast<double>(count) / static_cast<double>(grid.occupancy.size());
}

void write_grid(const StoredMap& stored, const DrawOptions& options, std::ostream& result) {
  const std::optional<OccupancyGrid> grid =
      occupancy_grid(stored.map, stored.plan, options.grid_options, fit_driving_plane(stored.map, up_of_base(stored)));
  if (!grid) {
    throw InputError(options.map_file().string(), "was not driven on a floor, so it has no occupancy grid",
                     "map with a camera on a wheeled robot");
  }
  write_floor_plan(grid->plan, grid->occupancy, *options.grid);
  result << row("grid", fmt::format("{} x {} cells of {:g} m: {:.1f} % occupied, {:.1f} % free, {:.1f} % unknown",
                                    grid->plan.width, grid->plan.height, options.grid_options.resolution,
                                    share_of(*grid, kOccupiedPixel), share_of(*grid, kFreePixel),
                                    share_of(*grid, kUnknownPixel)));
}

void write_plan_picture(const PlanScene& scene, const DrawOptions& options) {
  PlanPictureOptions picture;
  picture.width = options.width;
  picture.heights = options.heights;
  write_picture(plan_picture(scene, picture), *options.plan_picture);
}

void add_mission(const DrawnMission& mission, PlanScene& scene) {
  std::ranges::copy(mission.online.points, std::back_inserter(scene.map.points));
  std::ranges::copy(mission.online.keyframes, std::back_inserter(scene.map.keyframes));
  scene.paths.push_back(mission.path);
  if (!mission.frame || !mission.frame->report.map_from_body) return;
  scene.camera = plan_camera(*mission.frame->report.map_from_body, *mission.rig);
}

std::string describe_pictures(const DrawnMission& mission, const DrawOptions& options) {
  std::string text = row("mission", fmt::format("{} poses", mission.path.map_from_body.size()));
  if (mission.frame_s && options.camera_picture) text += row("camera at", fmt::format("{:.2f} s", *mission.frame_s));
  if (!options.video) return text;
  const char* const codec = mission.plays_in_browsers ? "H.264" : "MPEG-4, which browsers do not play";
  return text + row("video", fmt::format("{} frames, {}", mission.video_frames, codec));
}

void require_frames(const DrawnMission& mission, const DrawOptions& options) {
  const bool lacks_camera_picture = options.camera_picture && !mission.frame;
  const bool lacks_video = options.video && mission.video_frames == 0;
  if (lacks_camera_picture || lacks_video) throw std::runtime_error("no frame of the recording was read");
}

void write_camera_picture(const DrawnMission& mission, const fs::path& file) {
  CameraPictureOptions picture;
  picture.title = fmt::format("{:.2f} s", *mission.frame_s);
  write_picture(camera_picture(*mission.frame, picture), file);
}

ExitCode run_and_draw(const DrawOptions& options, PlanScene scene, std::ostream& result) {
  const DrawnMission mission = draw_mission(options, scene);
  if (!options.quiet) show_warnings(std::cerr, mission.warnings);
  require_frames(mission, options);
  result << describe_pictures(mission, options);
  if (options.camera_picture) write_camera_picture(mission, *options.camera_picture);
  add_mission(mission, scene);
  if (options.plan_picture) write_plan_picture(scene, options);
  return mission.stopped ? interrupted : done;
}

// Frees the map, which a mission reads again.
PlanScene map_scene(const DrawOptions& options, std::ostream& result) {
  const StoredMap stored = load_map_to_draw(options);
  result << row("map",
                options.map_file().string() +
                    fmt::format(", {} keyframes, {} points", stored.map.keyframe_count(), stored.map.point_count()));
  if (options.grid) write_grid(stored, options, result);
  return scene_without_mission(options, stored);
}

ExitCode draw(const DrawOptions& options, std::ostream& result) {
  for (const fs::path& output : options.outputs()) require_writable(output);
  if (options.grid) require_writable(plan_description(*options.grid));
  PlanScene scene = map_scene(options, result);
  ExitCode code = done;
  if (options.map) {
    code = run_and_draw(options, std::move(scene), result);
  } else if (options.plan_picture) {
    write_plan_picture(scene, options);
  }
  for (const fs::path& output : options.outputs()) result << row("written", output.string());
  if (options.grid) result << row("written", plan_description(*options.grid).string());
  return code;
}

}  // namespace

Action declare_draw(CLI::App& command) {
  const auto options = std::make_shared<DrawOptions>();
  declare_draw_options(command, *options);
  return [options](std::ostream& result) { return draw(*options, result); };
}

}  // namespace byre::cli
