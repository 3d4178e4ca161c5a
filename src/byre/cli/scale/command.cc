#include "byre/base/output_file.h"
#include "byre/base/report_row.h"
#include "byre/cli/commands.h"
#include "byre/cli/shared/arguments.h"
#include "byre/playback/archive/scale_by_distance.h"

#include <filesystem>
#include <memory>
#include <ostream>
#include <string>
#include <utility>

#include <CLI/CLI.hpp>
#include <fmt/core.h>

namespace byre::cli {
namespace {

struct ScaleOptions {
  std::filesystem::path map;
  std::pair<std::string, std::string> between;
  double metres = 0.0;
  std::filesystem::path output;
};

constexpr const char* kScaleFooter = R"(Examples:
  byre scale barn.byre --between point:1204 point:9433 --metres 4.20 -o barn_metric.byre
  byre scale barn.byre --between time:1403636580.1 time:1403636584.6 --metres 2.5 -o barn_metric.byre
  byre scale barn.byre --between 0.1,0.5,2.2 1.7,0.5,2.3 --metres 4.20 -o barn_metric.byre

A monocular map has no metric scale. A place is a map point by its number (as in the point cloud of "byre inspect"),
the camera position at a time, or a position in units of the map. Choose two places that are far apart: the relative
error of the scale is that of the distance. Missions then run on the map with one camera or with two.)";

ExitCode run_scale(const ScaleOptions& options, std::ostream& result) {
  require_writable(options.output);
  const ScaledMap scaled =
      scale_by_distance(load_map(options.map), options.between.first, options.between.second, options.metres);
  save_map(scaled.stored, options.output);
  result << row("before", fmt::format("{:g} units apart", scaled.distance))
         << row("now", fmt::format("{:g} m apart: a unit is {:g} m", options.metres, scaled.factor))
         << row("written", options.output.string());
  return ExitCode::done;
}

}  // namespace

Action declare_scale(CLI::App& command) {
  const auto options = std::make_shared<ScaleOptions>();
  add_input(command, Input::file, "MAP", options->map, "Monocular map of \"byre map\"")->required();
  add_text(command, "--between", options->between, "Two places of the map")->type_name("PLACE PLACE")->required();
  command.add_option("--metres", options->metres, "Distance between the two places")
      ->type_name("METRES")
      ->check(above_zero())
      ->required();
  add_output(command, Output::map, "-o,--output", options->output, "Map with lengths in metres")->required();
  command.footer(kScaleFooter);
  return [options](std::ostream& result) { return run_scale(*options, result); };
}

}  // namespace byre::cli
