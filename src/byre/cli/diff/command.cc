#include "byre/cli/commands.h"
#include "byre/cli/shared/file_arguments.h"
#include "byre/map/map_file.h"
#include "byre/playback/report/report.h"

#include <algorithm>
#include <array>
#include <filesystem>
#include <iterator>
#include <memory>
#include <ostream>
#include <vector>

#include <CLI/CLI.hpp>

namespace byre::cli {
namespace {

struct DiffOptions {
  std::filesystem::path before, after;
  bool json = false;
};

constexpr const char* kDiffFooter = R"(Example:
  byre diff barn.byre barn_2.byre

Counts the points and keyframes of one map that the other does not have at exactly the same position.)";

using Numbers = std::array<double, 3>;

std::vector<Numbers> sorted(std::vector<Numbers> positions) {
  std::ranges::sort(positions);
  return positions;
}

Numbers numbers_of(const Eigen::Vector3d& position) {
  return {position.x(), position.y(), position.z()};
}

std::vector<Numbers> points_of(const MapGraph& map) {
  std::vector<Numbers> points;
  for (const PointId id : map.point_ids()) points.push_back(numbers_of(map.find_point(id)->position_in_world));
  return sorted(std::move(points));
}

std::vector<Numbers> cameras_of(const MapGraph& map) {
  std::vector<Numbers> cameras;
  for (const KeyframeId id : map.keyframe_ids()) {
    cameras.push_back(numbers_of(inverse(map.keyframe_header(id)->camera_from_world).translation));
  }
  return sorted(std::move(cameras));
}

nlohmann::ordered_json changes(const std::vector<Numbers>& before, const std::vector<Numbers>& after) {
  std::vector<Numbers> same;
  std::ranges::set_intersection(before, after, std::back_inserter(same));
  return {{"same", same.size()}, {"removed", before.size() - same.size()}, {"added", after.size() - same.size()}};
}

ExitCode run_diff(const DiffOptions& options, std::ostream& result) {
  const MapGraph before = load_map(options.before).map, after = load_map(options.after).map;
  Report report{{{"program", "byre diff"},
                 {"version", BYRE_VERSION},
                 {"before", options.before.string()},
                 {"after", options.after.string()},
                 {"keyframes", changes(cameras_of(before), cameras_of(after))},
                 {"points", changes(points_of(before), points_of(after))}}};
  report.row("maps", "{before} -> {after}");
  report.row("keyframes", "{keyframes.same} the same, {keyframes.removed} removed, {keyframes.added} added");
  report.row("points", "{points.same} the same, {points.removed} removed, {points.added} added");
  result << (options.json ? to_json(report) : to_text(report, true));
  return ExitCode::done;
}

}  // namespace

Action declare_diff(CLI::App& command) {
  const auto options = std::make_shared<DiffOptions>();
  add_input(command, Input::file, "BEFORE", options->before, "Map")->type_name("MAP")->required();
  add_input(command, Input::file, "AFTER", options->after, "Map to compare with it")->type_name("MAP")->required();
  command.add_flag("--json", options->json, "Print the figures as JSON");
  command.footer(kDiffFooter);
  return [options](std::ostream& result) { return run_diff(*options, result); };
}

}  // namespace byre::cli
