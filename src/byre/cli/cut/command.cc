#include "byre/base/output_file.h"
#include "byre/base/report_row.h"
#include "byre/cli/commands.h"
#include "byre/cli/shared/arguments.h"
#include "byre/input_error.h"
#include "byre/map.h"

#include <algorithm>
#include <iterator>
#include <memory>
#include <numeric>
#include <ostream>

#include <CLI/CLI.hpp>
#include <fmt/core.h>

namespace byre::cli {
namespace {

struct CutOptions {
  std::filesystem::path map;
  std::vector<double> box;
  std::vector<double> polygon;
  bool keep = false;
  std::filesystem::path output;
};

constexpr const char* kCutFooter = R"(Examples:
  byre cut site.byre --polygon 0 0 12 0 12 8 0 8 -o site_2.byre
  byre cut barn.byre --box -1 -1 0 4 2 3 -o barn_2.byre
  byre cut site.byre --polygon 0 0 12 0 12 8 0 8 --keep -o annex.byre

Removes the points of a region, or with --keep all others, and the keyframes that see no other point. Everything else
stays where it is, with the registration on a floor plan. Corners of a polygon are metres on the plan, in order; a box is
given by its lowest and highest corner, lengths of the map, in the map's frame.)";

std::vector<int> points_in_region(const Map& map, const CutOptions& options) {
  if (!options.box.empty()) {
    const Eigen::Map<const Eigen::Vector3d> one(options.box.data()), other(options.box.data() + 3);
    return map.points_in_box(one.cwiseMin(other), one.cwiseMax(other));
  }
  std::vector<Eigen::Vector2d> corners;
  for (std::size_t i = 0; i + 1 < options.polygon.size(); i += 2) {
    corners.emplace_back(options.polygon[i], options.polygon[i + 1]);
  }
  return map.points_in_polygon(corners);
}

ExitCode run_cut(const CutOptions& options, std::ostream& result) {
  require_writable(options.output);
  const Map map = Map::load(options.map);
  const std::vector<int> region = points_in_region(map, options);
  std::vector<int> removed = region;
  if (options.keep) {
    std::vector<int> all(static_cast<std::size_t>(map.points()));
    std::iota(all.begin(), all.end(), 0);
    removed.clear();
    std::ranges::set_difference(all, region, std::back_inserter(removed));
  }
  if (removed.empty() || static_cast<int>(removed.size()) == map.points()) {
    throw InputError(options.map.string(), removed.empty() ? "would lose no point" : "would lose all points",
                     "check the region; byre inspect --points writes the positions of all points");
  }
  const Map rest = map.without_points(removed);
  rest.save(options.output);
  const auto change = [](int before, int after) { return fmt::format("{} -> {}", before, after); };
  result << row("points", change(map.points(), rest.points()))
         << row("keyframes", change(map.keyframes(), rest.keyframes())) << row("written", options.output.string());
  return ExitCode::done;
}

}  // namespace

Action declare_cut(CLI::App& command) {
  const auto options = std::make_shared<CutOptions>();
  add_input(command, Input::file, "MAP", options->map, "Map file of \"byre map -o\"")->required();
  CLI::Option* const box = command.add_option("--box", options->box, "Two opposite corners, lengths of the map")
                               ->type_name("X Y Z X Y Z")
                               ->expected(6)
                               ->check(between(-1e6, 1e6));
  command.add_option("--polygon", options->polygon, "Corners on the floor plan, metres")
      ->type_name("X Y X Y X Y ...")
      ->expected(6, 2000)
      ->check(between(-1e6, 1e6))
      ->excludes(box);
  check_when_parsed(command, [options = options.get()] {
    if (options->box.empty() && options->polygon.empty()) {
      throw CLI::ValidationError("no region is given (give --box or --polygon)");
    }
    if (options->polygon.size() % 2 != 0) throw CLI::ValidationError("--polygon", "has a corner without y");
  });
  command.add_flag("--keep", options->keep, "Keep the region and remove the rest");
  add_output(command, Output::map, "-o,--output", options->output, "Map without the region")->required();
  command.footer(kCutFooter);
  return [options](std::ostream& result) { return run_cut(*options, result); };
}

}  // namespace byre::cli
