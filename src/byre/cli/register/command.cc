#include "byre/base/output_file.h"
#include "byre/cli/commands.h"
#include "byre/cli/shared/arguments.h"
#include "byre/input_error.h"
#include "byre/map/mapped_tag.h"
#include "byre/playback/archive/register_map.h"
#include "byre/playback/report/map_report.h"
#include "byre/tag_file.h"

#include <cmath>
#include <memory>
#include <optional>
#include <ostream>
#include <utility>

#include <CLI/CLI.hpp>
#include <fmt/core.h>

namespace byre::cli {
namespace {

namespace fs = std::filesystem;

struct RegisterCommandOptions {
  fs::path map;
  fs::path plan;
  fs::path picks;  // empty: tags alone, or automatic
  bool automatic = false;
  std::optional<fs::path> tags;
  std::optional<fs::path> output;
  RegisterOptions registering;
  bool is_height_given = false;             // body height: tags are added
  std::optional<double> accepted_residual;  // metres; empty: kLargePlanResidual
  bool fix_scale = false;
  bool json = false;
};

constexpr const char* kRegisterFooter = R"(Examples:
  byre register barn.byre --plan plan.yaml --points picks.csv
  byre register barn.byre --plan plan.yaml --points picks.csv -o barn-plan.byre
  byre register site.byre --plan plan.png --points picks.csv -o site-plan.byre
  byre register barn.byre --plan plan.yaml --tags tags.yaml -o barn-plan.byre
  byre register barn.byre --plan plan.yaml --points picks.csv --fix-scale -o barn-plan.byre
  byre register barn.byre --plan plan.yaml --auto -o barn-plan.byre

Estimates the pose of a map on a floor plan from points picked in both. -o writes a copy of the map with its
registration, with which "byre run" and "byre localise" give poses on the plan (--frame plan). The plan is a
map_server YAML file, or an image with a world file. The vertical and the height of the floor are estimated from the
path of the robot. Wrong picks are detected from four picks on; six are better. A map without a metric scale gets the
scale of the plan; the scale of a metric map is compared with the plan. A wrong scale of a stereo map is a wrong
baseline: --fix-scale corrects both, if the plan is to scale. Doubts are reported and are not errors, but a map that
is off its plan by more than half a metre is not written unless --accept-residual allows it. --auto needs no picks: it
matches the walls of the map with those of the plan, and is refused unless one pose explains the map significantly
better than all others.
docs/reference/floor_plan.md describes the files and the figures.)";

ScaleCorrectedMap register_with_options(const RegisterCommandOptions& options, const FloorPlan& plan) {
  StoredMap stored = load_map(options.map);
  if (options.automatic) {
    const auto body_height =
        options.is_height_given ? std::optional(options.registering.registration.body_height) : std::optional<double>();
    Registering registering = register_by_walls(stored, options.map, read_plan_pixels(plan), body_height);
    return {std::move(stored), std::move(registering), 1.0};
  }
  if (options.fix_scale) return correct_scale(std::move(stored), options.map, plan, options.picks, options.registering);
  Registering registering = register_map(stored, options.map, plan, options.picks, options.registering);
  return {std::move(stored), std::move(registering), 1.0};
}

bool is_close_enough(const PlanFit& fit, const RegisterCommandOptions& options) {
  return residual_of(fit) <= options.accepted_residual.value_or(kLargePlanResidual);
}

[[noreturn]] void refuse_to_write(const PlanFit& fit, const RegisterCommandOptions& options) {
  const double residual = residual_of(fit);
  throw InputError(
      !options.picks.empty() ? options.picks.string()
      : options.tags         ? options.tags->string()
                             : options.map.string(),
      fmt::format("has residuals of {:.2f} m on the map, so the map is not written: poses on the plan would have the "
                  "same error",
                  residual),
      fmt::format(
          "correct wrong picks, the plan's resolution or its origin; --accept-residual {:.2f} writes the map anyway",
          std::ceil(1e2 * residual) / 1e2));
}

ExitCode run_register(RegisterCommandOptions options, std::ostream& result) {
  if (options.tags) options.registering.tags = read_tags(*options.tags);
  if (options.output) require_writable(*options.output);
  const FloorPlan plan = read_floor_plan(options.plan);
  const ScaleCorrectedMap registered = register_with_options(options, plan);
  const PlanFit& fit = registered.registering.fit;
  const bool is_kept = options.output && is_close_enough(fit, options);
  if (is_kept) {
    StoredMap stored = registered.stored;
    stored.plan = fit.registration;
    if (options.is_height_given) add_surveyed_tags(stored, options.registering.tags);
    save_map(stored, *options.output);
  }
  RegisterProtocol protocol{options.map.string(), plan, is_kept ? options.output->string() : "", {}};
  if (options.fix_scale) protocol.scaled_by = registered.factor;
  const Report report = registration_report(registered.registering, protocol);
  result << (options.json ? to_json(report) : to_text(report, false));
  if (options.output && !is_kept) refuse_to_write(fit, options);
  return ExitCode::done;
}

}  // namespace

Action declare_register(CLI::App& command) {
  const auto options = std::make_shared<RegisterCommandOptions>();
  add_input(command, Input::file, "MAP", options->map, "Map file of \"byre map -o\"")->required();
  add_input(command, Input::plan, "--plan", options->plan,
            "Floor plan: a map_server YAML file, or an image with a world file")
      ->required();
  add_input(command, Input::file, "--points", options->picks, "CSV file of points picked in the map and on the plan");
  add_input(command, Input::file, "--tags", options->tags,
            "AprilTags surveyed on the plan, with --points or instead: YAML, see docs/how-to/use_apriltags.md");
  CLI::Option* const output = add_output(command, Output::updated_map, "-o,--output", options->output,
                                         "Map with its registration on the plan (not written)");
  command.add_option("--pick-sigma", options->registering.picks.sigma, "Standard deviation of the picks (0.05)")
      ->type_name("METRES")
      ->check(between(1e-4, 100.0));
  CLI::Option* const height = command
                                  .add_option("--body-height", options->registering.registration.body_height,
                                              "Height of the body's origin above the floor (0)")
                                  ->type_name("METRES")
                                  ->check(between(-100.0, 100.0));
  command
      .add_option("--accept-residual", options->accepted_residual,
                  "Largest residual up to which the map is written (0.5)")
      ->type_name("METRES")
      ->check(between(0.0, 1e6))
      ->needs(output);
  command.add_flag("--fix-scale", options->fix_scale, "Correct the scale of a stereo map and its baseline by the plan")
      ->needs(output);
  command.add_flag("--auto", options->automatic, "Match the map's walls with the plan's, without picks")
      ->excludes("--points", "--tags", "--fix-scale");
  command.add_flag("--json", options->json, "Print the result as JSON");
  check_when_parsed(command, [options, height] {
    options->is_height_given = height->count() > 0;
    if (options->picks.empty() && !options->tags && !options->automatic) {
      throw CLI::ValidationError("--points",
                                 "give points picked in map and plan, surveyed tags (--tags), or both; or --auto");
    }
  });
  command.footer(kRegisterFooter);
  return [options](std::ostream& result) { return run_register(*options, result); };
}

}  // namespace byre::cli
