#include "byre/cli/draw/options.h"

#include "byre/cli/shared/file_arguments.h"
#include "byre/cli/shared/number_check.h"
#include "byre/cli/shared/outputs.h"
#include "byre/cli/shared/recording_options.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cmath>
#include <string>
#include <string_view>

#include <CLI/CLI.hpp>

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
  std::string extension = path.extension().string();
  std::ranges::transform(extension, extension.begin(), [](unsigned char c) { return std::tolower(c); });
  return extension;
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
                                       "Occupancy grid of the map: .pgm, with its description in .yaml next to it")
                                ->type_name("FILE");
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
            "Floor plan of the map: a map_server YAML file, or an image with a world file")
      ->type_name("FILE");
  add_input(command, Input::file, "--trajectory", options.trajectories,
            "Trajectory to draw, in the map's frame; may be repeated")
      ->type_name("FILE")
      ->allow_extra_args(false);
  add_input(command, Input::file, "--mission", options.missions,
            "Statistics of a mission on the map, to draw its path; may be repeated")
      ->type_name("FILE")
      ->allow_extra_args(false);
  add_input(command, Input::file, "--vocabulary", options.vocabulary,
            "Vocabulary for place recognition (the built-in one)")
      ->type_name("FILE");
}

void declare_outputs(CLI::App& command, DrawOptions& options) {
  CLI::Option* const map = command.get_option("--map");
  add_output(command, Output::picture, "-o,--plan-picture", options.plan_picture,
             "Map from above with the paths: .svg or .png")
      ->type_name("FILE");
  add_output(command, Output::picture, "--camera-picture", options.camera_picture,
             "Camera image with matched map points and health: .svg or .png")
      ->type_name("FILE")
      ->needs(map);
  command.add_option("--at", options.at_s, "Time of the camera picture since the recording's first frame (last frame)")
      ->type_name("SECONDS")
      ->check(from(0.0))
      ->needs(map);
  add_output(command, Output::video, "--video", options.video, "Video of both pictures for every frame: .mp4")
      ->type_name("FILE")
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

}  // namespace

std::vector<fs::path> DrawOptions::outputs() const {
  return given_paths({plan_picture, camera_picture, video, grid});
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

}  // namespace byre::cli
