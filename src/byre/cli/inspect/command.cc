#include "byre/base/binary_file.h"
#include "byre/base/output_file.h"
#include "byre/cli/commands.h"
#include "byre/cli/shared/arguments.h"
#include "byre/cli/shared/map_extrinsics.h"
#include "byre/cli/shared/outputs.h"
#include "byre/extrinsics_file.h"
#include "byre/input_error.h"
#include "byre/map/map_file.h"
#include "byre/playback/archive/point_cloud.h"
#include "byre/playback/report/inspection_report.h"
#include "byre/site.h"

#include <filesystem>
#include <memory>
#include <optional>
#include <ostream>

#include <CLI/CLI.hpp>
#include <fmt/core.h>

namespace byre::cli {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

struct InspectOptions {
  fs::path map;
  std::optional<fs::path> points;
  std::optional<fs::path> extrinsics;
  std::optional<fs::path> pictures;
  bool json = false;
  bool verbose = false;
};

constexpr const char* kInspectFooter = R"(Examples:
  byre inspect barn.byre
  byre inspect barn.byre --json
  byre inspect barn.byre --points points.ply
  byre inspect barn.byre --extrinsics robot.yaml
  byre inspect barn.byre --pictures pictures
  byre inspect farm.yaml

Errors are distances in the rectified image between the measured point and the projection of the map point.)";

// Named by keyframe: 000012.jpg.
void write_pictures(const MapGraph& map, const fs::path& folder) {
  make_folder(folder);
  for (const KeyframeId id : map.keyframe_ids()) {
    const std::vector<std::byte> jpeg = map.find_keyframe(id)->picture.jpeg();
    if (!jpeg.empty()) write_atomically(folder / fmt::format("{:06}.jpg", id.number), jpeg, Durability::unsynced);
  }
}

ExitCode inspect_site(const InspectOptions& options, std::ostream& result) {
  if (options.points || options.extrinsics || options.pictures) {
    throw InputError(options.map.string(), "is a site, and --points, --extrinsics and --pictures are of one map",
                     "give one of its maps");
  }
  const Site site = read_site(options.map);
  Report report{{{"site", site.name}, {"maps", Json::array()}, {"links", Json::array()}}};
  report.row("site", "{site}");
  for (const SiteMap& map : site.maps) {
    const StoredMap stored = open_map(map.map);
    Json figures = {{"name", map.name},
                    {"map", map.map.string()},
                    {"building", map.building},
                    {"height_m", map.height},
                    {"keyframes", stored.map.keyframe_count()},
                    {"points", stored.map.point_count()},
                    {"plan", stored.plan ? Json(stored.plan->plan) : Json()}};
    report.row("map",
               "{name}: {map}[{?building}, {building}], {height_m:g} m, {keyframes} keyframes, {points} points"
               "[, on the plan {plan}|, not registered on a plan]",
               figures);
    report.figures["maps"].push_back(std::move(figures));
  }
  for (const SiteLink& link : site.links) {
    Json figures = {{"kind", to_string(link.kind)},
                    {"from", site.maps[link.from].name},
                    {"to", site.maps[link.to].name},
                    {"on_plan", !link.polygon.empty()}};
    if (link.polygon.empty()) {
      figures["centre_m"] = {link.centre.x(), link.centre.y(), link.centre.z()};
      figures["radius_m"] = link.radius;
    }
    for (const Eigen::Vector2d& corner : link.polygon) figures["polygon_m"].push_back({corner.x(), corner.y()});
    report.row("link",
               "{kind} from {from} to {to}[{?on_plan}, {#polygon_m} corners on the plan"
               "|, {radius_m:g} m around {centre_m} in the map]",
               figures);
    report.figures["links"].push_back(std::move(figures));
  }
  result << (options.json ? to_json(report) : to_text(report, options.verbose));
  return ExitCode::done;
}

ExitCode run_inspect(const InspectOptions& options, std::ostream& result) {
  if (is_site_file(options.map)) return inspect_site(options, result);
  if (options.points) require_writable(*options.points);
  if (options.extrinsics) require_writable(*options.extrinsics);
  const std::string name = options.map.string();
  const std::vector<std::byte> bytes = read_file(options.map);
  const StoredMap stored = read_map(bytes, name);
  if (options.extrinsics) write_extrinsics(*options.extrinsics, extrinsics_of(stored, name));
  if (options.pictures) write_pictures(stored.map, *options.pictures);
  if (options.points) write_atomically(*options.points, point_cloud(stored.map));
  const MapInspection inspection = inspect(stored);
  Report report = inspection_report(stored, inspection, {name, bytes.size(), section_sizes(bytes, name)});
  if (options.extrinsics) {
    report.figures["extrinsics_file"] = options.extrinsics->string();
    report.row("extrinsics", "{extrinsics_file}; the height of the camera is not estimated");
  }
  result << (options.json ? to_json(report) : to_text(report, options.verbose));
  return ExitCode::done;
}

}  // namespace

Action declare_inspect(CLI::App& command) {
  const auto options = std::make_shared<InspectOptions>();
  add_input(command, Input::file, "MAP", options->map, "Map file of \"byre map -o\", or site file")
      ->type_name("MAP|SITE")
      ->required();
  command.add_flag("--verbose", options->verbose, "Print figures for developers too: features, words, errors, sizes");
  command.add_flag("--json", options->json, "Print the report as JSON, sizes in bytes, lengths in the map's unit");
  add_output(command, Output::point_cloud, "--points", options->points,
             "Also write the points, coloured by their observations. PLY format");
  add_output(command, Output::calibration, "--extrinsics", options->extrinsics,
             "Also write the extrinsics of the robot, estimated from wheel odometry. YAML format");
  add_output(command, Output::folder, "--pictures", options->pictures,
             "Also write the pictures of the keyframes to this new folder. JPEG format");
  command.footer(kInspectFooter);
  return [options](std::ostream& result) { return run_inspect(*options, result); };
}

}  // namespace byre::cli
