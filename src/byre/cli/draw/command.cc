#include "byre/base/output_file.h"
#include "byre/base/report_row.h"
#include "byre/base/text_file.h"
#include "byre/cli/commands.h"
#include "byre/cli/draw/mission.h"
#include "byre/cli/shared/arguments.h"
#include "byre/cli/shared/options.h"
#include "byre/cli/shared/outputs.h"
#include "byre/cli/shared/progress.h"
#include "byre/input_error.h"
#include "byre/io/image/plan_file.h"
#include "byre/io/recording/trajectory_input.h"
#include "byre/map/plan/occupancy_grid.h"
#include "byre/map/stored_calibration.h"
#include "byre/recording.h"
#include "byre/viewer/camera_picture.h"
#include "byre/viewer/mission_input.h"
#include "byre/viewer/plan_picture.h"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <iostream>
#include <iterator>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/core.h>

namespace byre::cli {
namespace {

namespace fs = std::filesystem;

constexpr const char* kDrawFooter = R"(Examples:
  byre draw barn.byre -o barn.svg
  byre draw barn.byre --grid barn.pgm --grid-resolution 0.05
  byre draw barn-plan.byre --plan plan.yaml --mission stats.json -o mission.svg
  byre draw barn.byre --trajectory morning.txt --trajectory evening.txt -o rounds.png
  byre draw evening_round --map barn.byre --end 30 --at 12.5 --camera-picture shot.png -o where.svg
  byre draw evening_round --map barn-plan.byre --plan plan.yaml --video round.mp4 --speed 4

For a map, a picture from above is drawn: points, keyframes, and the paths of trajectories or of the statistics of
"byre run --stats", which contain the verdict of each pose. A recording is run on --map as by "byre run"; the camera
image with the matched map points and a video of both can be drawn as well. --at is the time of the camera picture;
the plan picture shows position and direction of the camera at that time. A plan is drawn below maps registered by
"byre register". Exit code 1 if no frame of the recording could be read. docs/how-to/draw_pictures.md explains the
symbols.
--grid writes an occupancy grid for map_server and Nav2 from the points and keyframes of the map: FILE.pgm and
FILE.yaml.)";

std::string extension_of(const fs::path& path) {
  return lower_case(path.extension().string());
}

std::optional<HeightBand> parse_heights(std::string_view text) {
  HeightBand heights;
  const char* const end = text.data() + text.size();
  const auto [colon, error] = std::from_chars(text.data(), end, heights.low);
  if (error != std::errc() || colon == end || *colon != ':') return std::nullopt;
  const auto [last, second_error] = std::from_chars(colon + 1, end, heights.high);
  if (second_error != std::errc() || last != end || !(heights.low < heights.high) ||
      !std::isfinite(heights.high - heights.low))
    return std::nullopt;
  return heights;
}

// set: callable that takes the heights.
template <typename Set>
CLI::Option* declare_heights(CLI::App& command, const std::string& name, const std::string& help, Set set) {
  const auto parse = [name, set](const CLI::results_t& texts) {
    const std::optional<HeightBand> parsed = parse_heights(texts.front());
    if (!parsed) throw CLI::ValidationError(name, texts.front() + " is not LOW:HIGH in metres such as 0.1:2.5");
    set(*parsed);
    return true;
  };
  return command.add_option(name, parse, help)->type_name("LOW:HIGH")->expected(1);
}

void declare_grid(CLI::App& command, DrawOptions& options) {
  GridOptions& grid = options.grid_options;
  CLI::Option* const file = add_output(command, Output::grid, "--grid", options.grid,
                                       "Occupancy grid of the map: .pgm, with its description in .yaml next to it");
  command.add_option("--grid-resolution", grid.resolution, "Edge of a cell (0.05)")
      ->type_name("METRES")
      ->check(between(0.001, 10.0))
      ->needs(file);
  declare_heights(command, "--grid-heights", "Range of heights of obstacles above the floor, metres (0.1:1.8)",
                  [&grid](const HeightBand& heights) {
                    grid.low = heights.low;
                    grid.high = heights.high;
                  })
      ->needs(file);
  command.add_option("--footprint", grid.footprint_radius, "Radius of the robot, whose path is free in the grid (0.3)")
      ->type_name("METRES")
      ->check(between(0.0, 10.0))
      ->needs(file);
  command
      .add_option("--body-height", grid.body_height,
                  "Height of the body's origin above the floor, for the grid of a map without a plan (0; a camera's "
                  "must be given)")
      ->type_name("METRES")
      ->check(between(-100.0, 100.0))
      ->needs(file);
}

void declare_inputs(CLI::App& command, DrawOptions& options) {
  add_input(command, Input::recording, "INPUT", options.input, "Map file; or recording to run on the map of --map")
      ->type_name("MAP|RECORDING")
      ->required();
  add_input(command, Input::file, "--map", options.map, "Offline map on which the recording is run")->type_name("MAP");
  add_input(command, Input::plan, "--plan", options.plan,
            "Floor plan of the map: a map_server YAML file, or an image with a world file");
  add_input(command, Input::file, "--trajectory", options.trajectories,
            "Trajectory to draw, in the map's frame; may be repeated")
      ->allow_extra_args(false);
  add_input(command, Input::file, "--mission", options.missions,
            "Statistics of a mission on the map, to draw its path; may be repeated")
      ->allow_extra_args(false);
  declare_vocabulary_option(command, options.vocabulary);
}

void declare_outputs(CLI::App& command, DrawOptions& options) {
  CLI::Option* const map = command.get_option("--map");
  add_output(command, Output::picture, "-o,--plan-picture", options.plan_picture,
             "Map from above with the paths: .svg or .png");
  add_output(command, Output::picture, "--camera-picture", options.camera_picture,
             "Camera image with matched map points and health: .svg or .png")
      ->needs(map);
  command.add_option("--at", options.at_s, "Time of the camera picture since the recording's first frame (last frame)")
      ->type_name("SECONDS")
      ->check(from(0.0))
      ->needs(map);
  add_output(command, Output::video, "--video", options.video, "Video of both pictures for every frame: .mp4")
      ->needs(map);
  command.add_option("--speed", options.speed, "Playback speed of the video, relative to the recording (1)")
      ->type_name("FACTOR")
      ->check(between(0.01, 1000.0));
  command.add_option("--width", options.width, "Width of the plan picture (1200)")
      ->type_name("PIXELS")
      ->check(between(200, 8000));
}

void require_extension(const std::optional<fs::path>& file, const char* option,
                       const std::vector<std::string_view>& extensions) {
  if (!file || std::ranges::count(extensions, extension_of(*file)) > 0) return;
  std::string known;
  for (const std::string_view extension : extensions) known += (known.empty() ? "" : " or ") + std::string(extension);
  throw CLI::ValidationError(option, file->string() + " must end in " + known);
}

void require_consistent(const DrawOptions& options) {
  require_valid(options.range);
  if (options.outputs().empty()) {
    throw CLI::ValidationError("draw", "give a file to draw: --plan-picture (-o), --grid, --camera-picture or --video");
  }
  require_extension(options.plan_picture, "--plan-picture", {".svg", ".png"});
  require_extension(options.camera_picture, "--camera-picture", {".svg", ".png"});
  require_extension(options.video, "--video", {".mp4"});
  require_extension(options.grid, "--grid", {".pgm"});
}

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

void declare_draw_options(CLI::App& command, DrawOptions& options) {
  declare_inputs(command, options);
  declare_outputs(command, options);
  declare_heights(command, "--heights", "Range of heights of the drawn map points above the floor, metres (0.1:2.5)",
                  [&options](const HeightBand& heights) { options.heights = heights; });
  declare_grid(command, options);
  declare_open_options(command, options.open);
  declare_frame_range(command, options.range);
  declare_options_file(command, options.method);
  command.add_flag("--quiet", options.quiet, "Show no progress and no warnings");
  check_when_parsed(command, [&options] { require_consistent(options); });
  command.footer(kDrawFooter);
}

}  // namespace

std::vector<fs::path> DrawOptions::outputs() const {
  return given_paths({plan_picture, camera_picture, video, grid});
}

Action declare_draw(CLI::App& command) {
  const auto options = std::make_shared<DrawOptions>();
  declare_draw_options(command, *options);
  return [options](std::ostream& result) { return draw(*options, result); };
}

}  // namespace byre::cli
