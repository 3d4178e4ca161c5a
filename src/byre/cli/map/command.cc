#include "byre/base/output_file.h"
#include "byre/cli/commands.h"
#include "byre/cli/map/options.h"
#include "byre/cli/map/posed_map.h"
#include "byre/cli/shared/interrupt.h"
#include "byre/cli/shared/outputs.h"
#include "byre/cli/shared/run_input.h"
#include "byre/cli/shared/warnings.h"
#include "byre/features/image_threads.h"
#include "byre/map/map_file.h"
#include "byre/map/stored_calibration.h"
#include "byre/playback/autosave.h"
#include "byre/playback/report/calibration_report.h"
#include "byre/playback/report/record_file.h"
#include "byre/playback/report/run_report.h"
#include "byre/slam/system/stored_map.h"
#include "byre/slam/window/online_copy.h"

#include <algorithm>
#include <iostream>
#include <memory>
#include <utility>

namespace byre::cli {
namespace {

namespace fs = std::filesystem;

// Data saved with a map, and its path, without the map itself.
struct MapRecord {
  StoredMap about;
  std::optional<Vocabulary> vocabulary;  // empty if no map is saved
  std::string site;
  fs::path path;
};

// Saves the map; then `offline` equals the map read from the file.
void save(Map& offline, const SavedEstimates& estimates, const MapRecord& record) {
  const auto& [calibration, extrinsics, scale_sigma] = estimates;
  StoredMap stored = record.about;
  write_odometry_calibration(extrinsics, stored.notes);
  if (scale_sigma) stored.notes[kMetresNote] = metres_note(*scale_sigma);
  if (calibration) stored.recordings.back().refined = calibration;
  stored.map = std::exchange(offline, Map(Origin::offline));
  try {
    save_for_missions_and_reload(stored, *record.vocabulary, record.site, record.path);
  } catch (...) {
    offline = std::move(stored.map);
    throw;
  }
  offline = std::move(stored.map);
}

MapRun run_and_autosave(RunInput& input, const EngineOptions& run_options, const MapOptions& options,
                        const MapRecord& record, std::optional<Map> before, RecordFile& messages,
                        const InterruptCatcher& interrupt) {
  Autosave autosave(options.autosave_s.value_or(0.0), [&record](const Map& online, const SavedEstimates& estimates) {
    Map offline = offline_copy(online);
    save(offline, estimates, record);
  });
  MapRunHooks hooks;
  if (messages.is_wanted()) hooks.on_frame = [&messages](const RunView& view) { messages.note(view); };
  hooks.after_frame = [&messages](int, const MappedFrame& frame) {
    if (!frame.report) messages.note_unreadable(frame);
  };
  if (options.autosave_s) {
    hooks.on_map_update = [&autosave](const Map& online, const SavedEstimates& estimates) {
      autosave.update(online, estimates);
    };
  }
  MapRun run = input.run(run_options, hooks, interrupt, std::move(before));
  autosave.finish();
  run.warnings.insert(run.warnings.end(), autosave.failures().begin(), autosave.failures().end());
  return run;
}

void write_results(const MapOptions& options, const MapRun& run, const MapProtocol& protocol,
                   const ResourceUsage& resources, OutputWriter& outputs) {
  outputs.attempt(options.trajectory, run.final, options.trajectory_format);
  outputs.attempt(options.causal_trajectory, run.causal, options.trajectory_format);
  outputs.attempt([&] {
    if (options.stats) write_atomically(*options.stats, to_json(run, protocol, resources));
  });
}

// Takes the map to extend out of its record.
std::optional<Map> take_extended(const MapOptions& options, MapRecord& record) {
  if (!options.extended) return std::nullopt;
  record.about = load_for_mapping(*options.extended, *record.vocabulary);
  record.about.pose_source = PoseSource::slam;
  Map online = online_copy(record.about.map);
  record.about.map = Map(Origin::offline);
  return online;
}

// A recording with the calibration of an earlier recording shares its refined calibration.
void take_known_calibration(std::vector<SourceRecording>& recordings) {
  recordings.back().refined = stored_calibration(recordings, recordings.back().calibration);
}

MapRecord record_of(const MapOptions& options) {
  MapRecord record;
  // Detects a missing vocabulary before mapping.
  if (options.map || !options.no_loops) record.vocabulary = open_vocabulary(options.vocabulary);
  record.site = options.site;
  if (options.map) record.path = *options.map;
  return record;
}

MapProtocol protocol_of(const MapOptions& options, const MapRecord& record, const RunInput& input) {
  MapProtocol protocol;
  input.describe(protocol);
  protocol.options = options.engine_options();
  protocol.options.refined_calibration = record.about.recordings.back().refined;
  const std::vector<SourceRecording>& all = record.about.recordings;
  protocol.options.extrinsics = odometry_calibration_for(read_odometry_calibration(record.about.notes),
                                                         {all.begin(), all.end() - 1}, all.back().calibration);
  protocol.options.session.recording = static_cast<int>(record.about.recordings.size()) - 1;
  if (!options.no_loops) protocol.options.vocabulary = record.vocabulary;
  if (options.extended) protocol.extended = options.extended->string();
  for (const SourceRecording& source : record.about.recordings) protocol.recordings.push_back(source.name);
  return protocol;
}

ExitCode run_map_command(MapOptions options, std::ostream& result) {
  for (const fs::path& output : options.outputs()) require_writable(output);
  if (options.given_poses) return run_posed_map(options, result);
  MapRecord record = record_of(options);
  RunInput input(
      {options.recording, options.range, options.open, options.live, options.extended.has_value(), options.quiet});
  std::optional<Map> extended = take_extended(options, record);
  record.about.recordings.push_back(input.source());
  take_known_calibration(record.about.recordings);
  record.about.scale = input.scaled().is_metric ? MapScale::metric : MapScale::unknown;
  MapProtocol protocol = protocol_of(options, record, input);

  limit_image_threads(1);
  input.show_check();
  const InterruptCatcher interrupt;
  RecordFile messages(std::optional<McapWriter>(options.record), input.calibration(), options.record_images,
                      [](const std::string& fault) { show_warnings(std::cerr, {fault}); });
  MapRun run = run_and_autosave(input, protocol.options, options, record, std::move(extended), messages, interrupt);
  messages.finish(run);
  if (!options.quiet) show_warnings(std::cerr, run.warnings);
  if (const auto warning = calibration_warning(run.calibration, run.row_error)) show_warnings(std::cerr, {*warning});
  const ResourceUsage resources = resource_usage();
  input.note_times(run, record.about.recordings.back());
  input.note_frames(run, protocol);
  record.about.scale = run.is_metric ? MapScale::metric : MapScale::unknown;
  if (run.final.empty()) options.map.reset();  // nothing to save
  OutputWriter outputs;
  outputs.attempt([&] {
    if (options.map) save(run.map, {run.calibration, run.motion.calibration_to_store, run.motion.scale_sigma}, record);
  });
  write_results(options, run, protocol, resources, outputs);
  outputs.require_written();
  result << to_text(run, protocol, resources, names_of(options.outputs())) << input.report();
  if (interrupt.caught()) return ExitCode::interrupted;
  messages.require_written();
  require_frames(run);
  require_poses(run, protocol);
  return ExitCode::done;
}

}  // namespace

Action declare_map(CLI::App& command) {
  const auto options = std::make_shared<MapOptions>();
  declare_map_options(command, *options);
  return [options](std::ostream& result) { return run_map_command(*options, result); };
}

}  // namespace byre::cli
