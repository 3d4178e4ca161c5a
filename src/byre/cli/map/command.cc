#include "byre/base/output_file.h"
#include "byre/cli/commands.h"
#include "byre/cli/map/options.h"
#include "byre/cli/map/posed_map.h"
#include "byre/cli/shared/interrupt.h"
#include "byre/cli/shared/outputs.h"
#include "byre/cli/shared/run_input.h"
#include "byre/cli/shared/warnings.h"
#include "byre/features/image_threads.h"
#include "byre/playback/autosave.h"
#include "byre/playback/report/calibration_report.h"
#include "byre/playback/report/record_file.h"
#include "byre/playback/report/run_report.h"
#include "byre/slam/system/option_table.h"
#include "byre/slam/system/stored_map.h"
#include "byre/tag_file.h"

#include <iostream>
#include <memory>
#include <utility>

namespace byre::cli {
namespace {

namespace fs = std::filesystem;

RunResult play_and_autosave(Slam& slam, RunInput& input, const MapOptions& options, RecordFile& messages,
                            const InterruptCatcher& interrupt) {
  const SlamInputs& inputs = slam.impl().inputs();
  Autosave autosave(options.autosave_s.value_or(0.0), [&](StoredMap stored) {
    stored.map = offline_copy(std::move(stored.map));
    save_for_missions(std::move(stored), *inputs.vocabulary, inputs.site, *options.map);
  });
  PlayHooks hooks;
  if (messages.is_wanted()) hooks.on_frame = [&messages](const RunView& view) { messages.note(view); };
  hooks.after_frame = [&messages](int, const PlayedFrame& frame) {
    if (!frame.report) messages.note_unreadable(frame);
  };
  if (options.autosave_s) {
    hooks.on_map_update = [&autosave](const SlamImpl& now) {
      autosave.update(now.session().joined_online(), [&now] { return now.stored_metadata(); });
    };
  }
  RunResult run = input.play(slam, hooks, interrupt);
  autosave.finish();
  run.warnings.insert(run.warnings.end(), autosave.failures().begin(), autosave.failures().end());
  return run;
}

void write_results(const MapOptions& options, const RunResult& run, const Report& report, OutputWriter& outputs) {
  outputs.attempt(options.trajectory, run.final, options.trajectory_format);
  outputs.attempt(options.causal_trajectory, run.causal, options.trajectory_format);
  outputs.attempt([&] {
    if (options.stats) write_atomically(*options.stats, to_json(report, run));
  });
}

Slam make_slam(const MapOptions& options, const RunInput& input) {
  SlamOptions slam = slam_options(options.method.options());
  slam.recording = input.name();
  slam.site = options.site;
  slam.vocabulary = options.vocabulary;
  slam.baseline = options.open.baseline;
  if (options.tags) slam.tags = read_tags(*options.tags);
  slam.extrinsics = options.extrinsics.read(options.open);
  return options.extended ? Slam::extending(input.calibration(), *options.extended, slam)
                          : Slam::mapping(input.calibration(), slam);
}

RunProtocol protocol_of(const MapOptions& options, const Slam& slam, const RunInput& input) {
  RunProtocol protocol;
  input.describe(protocol);
  protocol.options = slam.impl().options();
  if (options.extended) protocol.extended = options.extended->string();
  for (const SourceRecording& source : slam.impl().inputs().extended.recordings) {
    protocol.recordings.push_back(source.name);
  }
  protocol.recordings.push_back(slam.impl().inputs().recording);
  return protocol;
}

void conclude(const MapOptions& options, const RunResult& run, Report& report) {
  if (run.final.empty()) return;  // an error follows
  constexpr double kFew = 0.05;   // share of frames without a pose
  const std::string recording = options.recording.empty() ? "RECORDING" : options.recording.string();
  report.conclude(
      "[{?stopped_early}Stopped after {counts.frames} of {protocol.frames_in_range} frames."
      "|{?has_gaps}{missing*100:.0f} % of the frames have no pose; \"byre check {recording}\" lists problems."
      "|{?is_unscaled}Complete, but of arbitrary scale; \"byre scale\" sets it.|Complete.] "
      "Next: [byre run {recording} --map {map}|byre map {recording} -o MAP.byre, which saves the map]",
      {{"recording", recording},
       {"missing", 1.0 - report.figures["counts"]["coverage"].get<double>()},
       {"has_gaps", report.figures["counts"]["coverage"].get<double>() < 1.0 - kFew},
       {"is_unscaled", !run.is_metric},
       {"map", options.map ? nlohmann::ordered_json(options.map->string()) : nlohmann::ordered_json()}});
}

ExitCode run_map_command(MapOptions options, std::ostream& result) {
  for (const fs::path& output : options.outputs()) require_writable(output);
  if (options.given_poses) return run_posed_map(options, result);
  open_vocabulary(options.vocabulary);  // detects a missing vocabulary before the recording is opened
  RunInput input(
      {options.recording, options.range, options.open, options.live, options.extended.has_value(), options.quiet});
  Slam slam = make_slam(options, input);
  RunProtocol protocol = protocol_of(options, slam, input);

  limit_image_threads(1);
  input.show_check();
  const InterruptCatcher interrupt;
  RecordFile messages(std::optional<McapWriter>(options.record), input.calibration(), options.record_images,
                      [](const std::string& fault) { show_warnings(std::cerr, {fault}); });
  RunResult run = play_and_autosave(slam, input, options, messages, interrupt);
  messages.finish(run);
  if (!options.quiet) show_warnings(std::cerr, run.warnings);
  if (const auto warning = calibration_warning(run.calibration, run.row_error)) show_warnings(std::cerr, {*warning});
  const ResourceUsage resources = resource_usage();
  input.note_frames(run, protocol);
  if (run.final.empty()) options.map.reset();  // nothing to save
  OutputWriter outputs;
  outputs.attempt([&] {
    const SlamInputs& inputs = slam.impl().inputs();
    if (options.map) save_for_missions_and_reload(run.stored, *inputs.vocabulary, inputs.site, *options.map);
  });
  Report report = run_report(run, protocol, resources);
  write_results(options, run, report, outputs);
  outputs.require_written();
  report.row("written", "{?files}{files}", {{"files", names_of(options.outputs())}});
  conclude(options, run, report);
  result << to_text(report, options.verbose) << input.report();
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
