#include "byre/base/output_file.h"
#include "byre/cli/commands.h"
#include "byre/cli/shared/arguments.h"
#include "byre/cli/shared/changes_picture.h"
#include "byre/cli/shared/options.h"
#include "byre/map/map_file.h"
#include "byre/playback/report/map_report.h"
#include "byre/slam/system/stored_map.h"

#include <iostream>
#include <memory>
#include <ostream>

#include <CLI/CLI.hpp>

namespace byre::cli {
namespace {

namespace fs = std::filesystem;

struct UpdateOptions {
  fs::path map;
  std::vector<fs::path> sessions;
  fs::path output;
  std::optional<fs::path> vocabulary;
  ChangesPicture picture;
  bool json = false;
  bool quiet = false;
};

constexpr const char* kUpdateFooter = R"(Examples:
  byre run evening_round --map barn.byre --save-session evening.session
  byre update barn.byre evening.session -o barn_2.byre
  byre update barn.byre monday.session tuesday.session -o barn_2.byre --picture changes.svg

Adds what missions mapped at new and changed places, and removes points that they no longer see. All other keyframes and
points keep their positions, so taught paths stay valid. A session is used if it ran on MAP or an earlier version of it,
with the map's calibration, and if its keyframes are localised in MAP at their poses. Then all stored frames are
localised in both maps; NEW is written only if no place is worse. Misses count only for sessions that ran on MAP.
"byre history" lists the updates of a map; "byre diff" and "byre view NEW --before MAP" compare versions.
Exit code 1 if no session fits, or a place would be worse: NEW is then not written.)";

void draw_changes(const UpdateOptions& options) {
  if (!options.picture.file) return;
  const Map before(load_map(options.map)), after(load_map(options.output));
  write_changes(before, after, before.difference(after), options.output.stem().string(), options.picture);
}

ExitCode run_update(const UpdateOptions& options, std::ostream& result) {
  require_writable(options.output);
  const Vocabulary vocabulary = open_vocabulary(options.vocabulary);
  const MapVersion parent = load_version(options.map, vocabulary);
  std::vector<StoredSession> sessions;
  for (const fs::path& path : options.sessions) sessions.push_back(load_session(path, vocabulary));
  MapUpdate update = update_map(parent, sessions, vocabulary, [&options](const char* step) {
    if (!options.quiet) std::cerr << "updating: " << step << "\n";
  });
  const Report report = update_report(update, {options.map.string(), options.output.string(),
                                               parent.stored.map.keyframe_count(), parent.stored.map.point_count()});
  const bool is_refused = !update.child;
  if (!is_refused) {
    save_child(std::move(update), vocabulary, options.output);
    draw_changes(options);
  }
  result << (options.json ? to_json(report) : to_text(report, true));
  return is_refused ? ExitCode::failed : ExitCode::done;
}

}  // namespace

Action declare_update(CLI::App& command) {
  const auto options = std::make_shared<UpdateOptions>();
  add_input(command, Input::file, "MAP", options->map, "Map on which the missions ran")->required();
  add_input(command, Input::file, "SESSION", options->sessions, "Sessions of \"byre run --save-session\"")->required();
  add_output(command, Output::map, "-o,--output", options->output, "Updated map")->type_name("NEW")->required();
  declare_vocabulary_option(command, options->vocabulary);
  declare_changes_picture(command, options->picture);
  command.add_flag("--json", options->json, "Print the report as JSON");
  command.add_flag("--quiet", options->quiet, "Show no progress");
  command.footer(kUpdateFooter);
  return [options](std::ostream& result) { return run_update(*options, result); };
}

}  // namespace byre::cli
