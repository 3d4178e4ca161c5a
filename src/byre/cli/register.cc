#include "byre/cli/commands.h"
#include "byre/cli/output_file.h"
#include "byre/cli/register_report.h"
#include "byre/cli/register_run.h"

#include <memory>
#include <optional>
#include <ostream>
#include <utility>

#include <CLI/CLI.hpp>

namespace byre::cli {
namespace {

namespace fs = std::filesystem;

struct RegisterCommandOptions {
  fs::path map;
  fs::path plan;
  fs::path picks;
  std::optional<fs::path> output;
  RegisterOptions registering;
  bool json = false;
};

constexpr const char* kFooter = R"(Examples:
  byre register barn.byre --plan plan.yaml --points picks.csv
  byre register barn.byre --plan plan.yaml --points picks.csv -o barn-plan.byre
  byre register site.byre --plan plan.png --points picks.csv -o site-plan.byre

Finds where a map lies on a floor plan, from points picked in both: with -o a copy of the map that knows it, with which
"byre run" and "byre localise" give poses on the plan (--frame plan). The plan is a map_server YAML file, or an image
with a world file beside it. Which way is up, and how high the floor lies, comes from the path that was driven. A wrong
pick is found when four or more are given, better six. A map without a metric scale gets one on the plan. Doubts are
told, and are no errors. docs/floor_plan.md describes the files and the figures.)";

ExitCode run_register(const RegisterCommandOptions& options, std::ostream& result) {
  if (options.output) require_writable(*options.output);
  const FloorPlan plan = read_floor_plan(options.plan);
  StoredMap stored = load_map(options.map);
  const Registering registering = register_map(stored, options.map, plan, options.picks, options.registering);
  if (options.output) {
    stored.plan = registering.fit.registration;
    save_map(stored, *options.output);
  }
  const auto print = options.json ? to_json : to_text;
  result << print(registering, {options.map.string(), plan, options.output.value_or("").string()});
  return ExitCode::done;
}

}  // namespace

Action declare_register(CLI::App& command) {
  const auto options = std::make_shared<RegisterCommandOptions>();
  command.add_option("MAP", options->map, "Map file, as \"byre map -o\" writes it")->type_name("MAP")->required();
  command.add_option("--plan", options->plan, "The floor plan: a map_server YAML file, or an image with a world file")
      ->type_name("FILE")
      ->required();
  command.add_option("--points", options->picks, "Points picked in the map and on the plan: a CSV file")
      ->type_name("FILE")
      ->required();
  command.add_option("-o,--output", options->output, "The map with its place on the plan (none is written)")
      ->type_name("MAP");
  command.add_option("--pick-sigma", options->registering.pick_sigma, "How well points were picked, one sigma (0.05)")
      ->type_name("METRES")
      ->check(CLI::Range(1e-4, 100.0).description(""));
  command
      .add_option("--body-height", options->registering.registration.body_height,
                  "How high the body's origin is above the floor (0)")
      ->type_name("METRES")
      ->check(CLI::Range(-100.0, 100.0).description(""));
  command.add_flag("--json", options->json, "Print the result as JSON");
  command.footer(kFooter);
  return [options](std::ostream& result) { return run_register(*options, result); };
}

}  // namespace byre::cli
