#include "byre/base/output_file.h"
#include "byre/cli/commands.h"
#include "byre/cli/shared/arguments.h"
#include "byre/cli/shared/options.h"
#include "byre/cli/shared/progress.h"
#include "byre/place/map_words.h"
#include "byre/playback/report/map_report.h"
#include "byre/slam/system/merge_maps.h"
#include "byre/slam/system/stored_map.h"

#include <memory>
#include <ostream>

#include <CLI/CLI.hpp>

namespace byre::cli {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

struct MergeOptions {
  fs::path first;
  fs::path second;
  fs::path output;
  std::optional<fs::path> vocabulary;
  bool json = false;
  bool quiet = false;
};

constexpr const char* kMergeFooter = R"(Examples:
  byre merge barn.byre annex.byre -o site.byre
  byre merge barn.byre phone.byre -o barn_2.byre --json

Merges two maps that overlap. Keyframes of SECOND are localised in FIRST. They must agree on one placement: at least
five, more than half of those found, and 60 % of those that it puts beside keyframes of FIRST. Loops are then searched
between both maps, and both are adjusted together around them. The merged map has the frame and the floor plan of FIRST.
A SECOND of unknown scale, made by one camera, gets the scale of FIRST.
Exit code 1 if the maps do not overlap, or no loop confirms the placement: MERGED is then not written.)";

Report merge_report(const MergeOptions& options, const MergedMaps& merged) {
  const MapPlace& place = merged.place;
  Report report{{{"program", "byre merge"},
                 {"version", BYRE_VERSION},
                 {"first", options.first.string()},
                 {"second", options.second.string()},
                 {"keyframes_searched", place.keyframes},
                 {"keyframes_found", place.found},
                 {"keyframes_agreeing", place.agreeing},
                 {"keyframes_expected", place.expected},
                 {"scale", place.target_from_source ? Json(place.target_from_source->scale) : Json()},
                 {"refusal", merged.refusal.empty() ? Json() : Json(merged.refusal)}}};
  report.row("placed",
             "{keyframes_found} of {keyframes_searched} keyframes of {second} found in {first}, "
             "{keyframes_agreeing} agree");
  if (!merged.refusal.empty()) {
    report.conclude(
        "Not merged: {refusal}. Record where both maps overlap, and extend one: byre map RECORDING --extend "
        "{first} -o MERGED");
    return report;
  }
  const Report finish = finish_report(merged.finishing);
  report.figures["finishing"] = finish.figures;
  report.figures["written"] = options.output.string();
  report.append(finish);
  report.row("map", "{written}: {finishing.after.keyframes} keyframes, {finishing.after.points} points");
  report.conclude("Next: byre run RECORDING --map {written}");
  return report;
}

ExitCode run_merge(const MergeOptions& options, std::ostream& result) {
  require_writable(options.output);
  const Vocabulary vocabulary = open_vocabulary(options.vocabulary);
  StoredMap first = load_for_mapping(options.first, vocabulary);
  StoredMap second = load_map(options.second);
  add_words(second, vocabulary);
  const InterruptCatcher interrupt;
  const MergedMaps merged = merge_maps(first, second, vocabulary, finish_hooks(interrupt, options.quiet));
  if (interrupt.caught()) return ExitCode::interrupted;
  const bool is_refused = !merged.refusal.empty();
  if (!is_refused) save_for_missions(std::move(first), vocabulary, "", options.output);
  const Report report = merge_report(options, merged);
  result << (options.json ? to_json(report) : to_text(report, true));
  return is_refused ? ExitCode::failed : ExitCode::done;
}

}  // namespace

Action declare_merge(CLI::App& command) {
  const auto options = std::make_shared<MergeOptions>();
  add_input(command, Input::file, "FIRST", options->first, "Map whose frame is kept")->required();
  add_input(command, Input::file, "SECOND", options->second, "Map that overlaps it")->required();
  add_output(command, Output::map, "-o,--output", options->output, "Merged map")->type_name("MERGED")->required();
  declare_vocabulary_option(command, options->vocabulary);
  command.add_flag("--json", options->json, "Print the report as JSON");
  command.add_flag("--quiet", options->quiet, "Show no progress");
  command.footer(kMergeFooter);
  return [options](std::ostream& result) { return run_merge(*options, result); };
}

}  // namespace byre::cli
