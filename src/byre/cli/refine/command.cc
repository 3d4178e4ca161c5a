#include "byre/base/output_file.h"
#include "byre/cli/commands.h"
#include "byre/cli/shared/arguments.h"
#include "byre/cli/shared/options.h"
#include "byre/cli/shared/progress.h"
#include "byre/playback/report/map_report.h"
#include "byre/slam/system/refine_map.h"
#include "byre/slam/system/stored_map.h"

#include <memory>
#include <ostream>

#include <CLI/CLI.hpp>

namespace byre::cli {
namespace {

namespace fs = std::filesystem;

struct RefineOptions {
  fs::path map;
  std::optional<fs::path> output;  // empty: replaces the input
  std::optional<fs::path> vocabulary;
  bool json = false;
  bool quiet = false;

  const fs::path& written() const { return output ? *output : map; }
};

constexpr const char* kRefineFooter = R"(Examples:
  byre refine barn.byre
  byre refine barn.byre -o better.byre --json

Repeats the last step of "byre map": searches for loops, adjusts all keyframes and points together, and removes weak
points and redundant keyframes. Without -o the map is replaced, completely or not at all. Given or imported poses are
adjusted too. Ctrl-C keeps the result so far, with exit code 130.)";

Report refine_report(const RefineOptions& options, const FinishResult& finishing) {
  const Report finish = finish_report(finishing);
  Report report{{{"program", "byre refine"},
                 {"version", BYRE_VERSION},
                 {"map", options.map.string()},
                 {"written", options.written().string()},
                 {"finishing", finish.figures}}};
  report.row("map", "{map}: {finishing.after.keyframes} keyframes, {finishing.after.points} points");
  report.append(finish);
  report.row("written", "{written}");
  report.conclude("Next: byre run RECORDING --map {written}");
  return report;
}

ExitCode run_refine(const RefineOptions& options, std::ostream& result) {
  require_writable(options.written());
  const Vocabulary vocabulary = open_vocabulary(options.vocabulary);
  StoredMap stored = load_for_mapping(options.map, vocabulary);

  const InterruptCatcher interrupt;
  const FinishResult finishing = refine_map(stored, vocabulary, finish_hooks(interrupt, options.quiet));
  save_for_missions(std::move(stored), vocabulary, "", options.written());
  const Report report = refine_report(options, finishing);
  result << (options.json ? to_json(report) : to_text(report, true));
  return interrupt.caught() ? ExitCode::interrupted : ExitCode::done;
}

}  // namespace

Action declare_refine(CLI::App& command) {
  const auto options = std::make_shared<RefineOptions>();
  add_input(command, Input::file, "MAP", options->map, "Map file of \"byre map -o\"")->required();
  add_output(command, Output::refined_map, "-o,--output", options->output, "Refined map (default: replaces the input)");
  declare_vocabulary_option(command, options->vocabulary);
  command.add_flag("--json", options->json, "Print the changes as JSON");
  command.add_flag("--quiet", options->quiet, "Show no progress");
  command.footer(kRefineFooter);
  return [options](std::ostream& result) { return run_refine(*options, result); };
}

}  // namespace byre::cli
