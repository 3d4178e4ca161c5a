#include "byre/base/output_file.h"
#include "byre/cli/commands.h"
#include "byre/cli/shared/arguments.h"
#include "byre/cli/shared/progress.h"
#include "byre/cli/shared/view_run.h"
#include "byre/io/recording/timed_files.h"
#include "byre/playback/report/inspection_report.h"
#include "byre/slam/system/resources.h"
#include "byre/tag_file.h"
#include "byre/viewer/web/web_map.h"

#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include <CLI/CLI.hpp>

namespace byre::cli {
namespace {

namespace fs = std::filesystem;

struct ViewCommandOptions {
  fs::path map;
  std::optional<fs::path> before;
  ViewOptions view;
  std::optional<fs::path> output;
  bool overwrite = false;
  double pick_sigma = PlanCorrespondence{}.sigma;  // metres
  std::optional<double> body_height;               // metres
  std::optional<fs::path> tags;
  bool quiet = false;
};

constexpr const char* kViewFooter = R"(Examples:
  byre view barn.byre
  byre view barn.byre --plan plan.yaml -o barn-plan.byre
  byre view barn_2.byre --before barn.byre
  byre view barn.byre --bind 0.0.0.0

Shows a map in a browser, at the address printed on the standard error stream, until Ctrl-C. With a floor plan,
points are picked in the map and on the plan, and the page shows the residuals; with -o it can save a copy of the map
with its registration on the plan, as by "byre register", and the picks (barn-plan.picks.csv).
docs/how-to/watch_in_browser.md describes the page.)";

std::vector<fs::path> outputs_of(const ViewCommandOptions& options) {
  if (!options.output) return {};
  return {*options.output, picks_path(*options.output)};
}

ExitCode view(const ViewCommandOptions& options) {
  const InterruptCatcher interrupt;
  ViewedMap viewed;
  viewed.name = options.map.filename().string();
  viewed.stored = load_map(options.map);
  viewed.next_step = next_step_with(viewed.stored, viewed.name);
  if (options.before) {
    viewed.changes = changes_between(options.before->filename().string(), load_map(*options.before), viewed.stored);
  }
  if (options.view.plan) viewed.plan = read_floor_plan(*options.view.plan);
  viewed.output = options.output;
  for (const fs::path& output : outputs_of(options)) require_writable(output);
  viewed.pick_sigma = options.pick_sigma;
  viewed.body_height = options.body_height;
  viewed.registration.body_height = options.body_height.value_or(0.0);
  if (options.tags) viewed.tags = read_tags(*options.tags);
  raise_descriptor_limit();
  const MapViewer viewer(std::move(viewed), options.view.server);
  announce(viewer.urls());
  serve_until_interrupted(interrupt, options.quiet);
  return ExitCode::done;
}

// Resolves links; neither file needs to exist.
bool is_same_file(const fs::path& a, const fs::path& b) {
  return fs::weakly_canonical(fs::absolute(a)) == fs::weakly_canonical(fs::absolute(b));
}

void require_consistent(const ViewCommandOptions& options) {
  if (options.output && is_same_file(*options.output, options.map) && !options.overwrite) {
    throw CLI::ValidationError("--output", "is the map itself: give another file, or allow it with --overwrite");
  }
}

}  // namespace

Action declare_view(CLI::App& command) {
  const auto options = std::make_shared<ViewCommandOptions>();
  add_input(command, Input::file, "MAP", options->map, "Map file of \"byre map -o\"")->required();
  declare_viewer_options(command, options->view, "Floor plan to pick points on");
  add_input(command, Input::file, "--before", options->before,
            "Earlier version of the map: the page shows removed and added points")
      ->type_name("MAP");
  CLI::Option* const output = add_output(command, Output::viewed_map, "-o,--output", options->output,
                                         "File to which the page saves the map with its registration on the plan")
                                  ->needs("--plan");
  command.add_flag("--overwrite", options->overwrite, "Allow the output to replace the map")->needs(output);
  command.add_option("--pick-sigma", options->pick_sigma, "Standard deviation of the picks (0.05)")
      ->type_name("METRES")
      ->check(between(1e-4, 100.0));
  command.add_option("--body-height", options->body_height, "Height of the body's origin above the floor (0)")
      ->type_name("METRES")
      ->check(between(-100.0, 100.0));
  add_input(command, Input::file, "--tags", options->tags,
            "AprilTags surveyed on the plan, in addition to picks: YAML, see docs/how-to/use_apriltags.md")
      ->needs("--plan");
  command.add_flag("--quiet", options->quiet, "Print only the address");
  check_when_parsed(command, [options] { require_consistent(*options); });
  command.footer(kViewFooter);
  return [options](std::ostream&) { return view(*options); };
}

}  // namespace byre::cli
