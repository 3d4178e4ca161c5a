#include "byre/cli/commands.h"
#include "byre/cli/shared/arguments.h"
#include "byre/cli/shared/changes_picture.h"
#include "byre/map.h"
#include "byre/map/map_file.h"
#include "byre/playback/report/report.h"

#include <filesystem>
#include <memory>
#include <ostream>
#include <vector>

#include <CLI/CLI.hpp>

namespace byre::cli {
namespace {

namespace fs = std::filesystem;

struct DiffOptions {
  fs::path before, after;
  ChangesPicture picture;
  bool json = false;
};

constexpr const char* kDiffFooter = R"(Examples:
  byre diff barn.byre barn_2.byre
  byre diff barn.byre barn_2.byre --picture changes.svg --plan plan.yaml

Counts the points and keyframes of one map that the other does not have at exactly the same position. The picture shows
removed and added points from above, with the keyframes of the second map. byre view AFTER --before BEFORE shows them in
a browser, with pictures.)";

nlohmann::ordered_json changes(int before, const std::vector<int>& removed, const std::vector<int>& added) {
  return {{"same", before - static_cast<int>(removed.size())}, {"removed", removed.size()}, {"added", added.size()}};
}

ExitCode run_diff(const DiffOptions& options, std::ostream& result) {
  const Map before(load_map(options.before)), after(load_map(options.after));
  const MapDifference difference = before.difference(after);
  write_changes(before, after, difference, options.before.stem().string() + " -> " + options.after.stem().string(),
                options.picture);
  Report report{{{"program", "byre diff"},
                 {"version", BYRE_VERSION},
                 {"before", options.before.string()},
                 {"after", options.after.string()},
                 {"keyframes", changes(before.keyframes(), difference.removed_keyframes, difference.added_keyframes)},
                 {"points", changes(before.points(), difference.removed_points, difference.added_points)}}};
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
  declare_changes_picture(command, options->picture);
  command.add_flag("--json", options->json, "Print the figures as JSON");
  command.footer(kDiffFooter);
  return [options](std::ostream& result) { return run_diff(*options, result); };
}

}  // namespace byre::cli
