#include "byre/cli/shared/run_input.h"

#include "byre/base/report_row.h"
#include "byre/calibration_file.h"
#include "byre/cli/shared/arguments.h"
#include "byre/geometry/baseline.h"
#include "byre/io/recording/motion_files.h"
#include "byre/playback/report/recording_report.h"
#include "byre/slam/system/option_table.h"

#include <iostream>
#include <utility>

#include <CLI/CLI.hpp>

namespace byre::cli {
namespace {

constexpr const char* kLiveName = "live";

// Monocular mapping uses the camera as the body, as open_scaled does for recordings.
Calibration scaled_calibration(Calibration calibration, bool has_metric_map, ScaledRecording& scaled) {
  if (has_metric_map || calibration.is_metric()) return calibration;
  scaled.is_metric = false;
  scaled.body_from_camera = calibration.body_from_left;
  calibration.body_from_left = {};
  return calibration;
}

}  // namespace

SlamOptions RunInputOptions::slam(const std::string& name) const {
  SlamOptions slam = slam_options(method.options());
  slam.recording = name;
  slam.vocabulary = vocabulary;
  slam.baseline = open.baseline;
  slam.extrinsics = extrinsics.read(open);
  return slam;
}

void declare_recording_argument(CLI::App& command, RunInputOptions& options) {
  add_input(command, Input::recording, "RECORDING", options.recording, kRecordingHelp)->type_name("FOLDER|VIDEO|BAG");
}

void declare_run_input(CLI::App& command, RunInputOptions& options) {
  declare_open_options(command, options.open);
  declare_extrinsics(command, options.extrinsics);
  declare_frame_range(command, options.range);
  declare_live_options(command, options.live, options.method);
  declare_pace(command, options.method);
}

void declare_run_output(CLI::App& command, RunInputOptions& options) {
  declare_trajectory_format(command, options.trajectory_format);
  declare_recording(command, options.record, options.record_images);
  declare_options_file(command, options.method);
  command.add_flag("--quiet", options.quiet, "Show no progress and no warnings");
  command.add_flag("--verbose", options.verbose, "Print figures for developers too: loops, inliers, times, memory");
}

void require_consistent_input(const RunInputOptions& options) {
  require_valid(options.range);
  if (options.recording.empty() && !options.live.is_wanted()) {
    throw CLI::ValidationError("RECORDING", "give a recording, or cameras (--live /dev/video0)");
  }
  if (options.live.is_wanted() && !options.open.calibration) {
    throw CLI::ValidationError("--live", "needs the calibration of the cameras (--calibration FILE)");
  }
}

RunInput::RunInput(const RunInputOptions& options, bool has_metric_map) : options_(options) {
  if (!options_.live.is_wanted()) {
    scaled_ = open_scaled(options_.recording, options_.range, options_.open, has_metric_map);
    if (!options_.quiet) show_warnings(std::cerr, scaled_.recording->warnings());
    return;
  }
  const std::filesystem::path& file = *options_.open.calibration;
  const auto on_note = [](const std::string& note) {
    show_warnings(std::cerr, {note});
  };  // shown even if quiet, as it needs attention
  const Calibration calibration = with_checked_baseline(read_calibration(file, options_.open.right_calibration),
                                                        options_.open.baseline, file.string(), "--baseline ");
  live_ = open_live(options_.live, scaled_calibration(calibration, has_metric_map, scaled_), file.string(), on_note);
}

const Calibration& RunInput::calibration() const {
  return live_ ? live_->frames->calibration() : scaled_.recording->calibration();
}

void RunInput::show_check() const {
  if (live_ || options_.quiet) return;
  constexpr int kSamples = 5;
  const RecordingCheck check = check_recording(*scaled_.recording, kSamples);
  std::cerr << row("checked", summary_of(check));
  std::vector<std::string> warnings;
  for (const Finding& finding : findings_of(check)) warnings.push_back(finding.what + ": " + finding.remedy);
  show_warnings(std::cerr, warnings);
}

void RunInput::describe(RunProtocol& protocol) const {
  protocol.is_metric = scaled_.is_metric;
  if (live_) {
    protocol.recording = options_.live.name();
    protocol.format.reset();
    protocol.camera = calibration().right ? CameraChoice::stereo : CameraChoice::left;
    return;
  }
  protocol.recording = options_.recording.string();
  protocol.format = guess_format(options_.recording);
  protocol.camera = camera_of(*scaled_.recording, options_.open);
  protocol.range = options_.range;
  protocol.frames_in_range = scaled_.recording->size();
  protocol.times = scaled_.recording->time_corrections();
}

std::string RunInput::name() const {
  return live_ ? kLiveName : source_name(options_.recording);
}

WatchedRun RunInput::watched(const std::optional<std::filesystem::path>& map,
                             std::shared_ptr<const OfflineMap> offline) const {
  WatchedRun run{name(), calibration(), 0, {}, map, std::move(offline)};
  if (live_) return run;
  run.frames = scaled_.recording->size();
  run.last_time = scaled_.recording->times().back();
  return run;
}

void RunInput::note_frames(const RunResult& run, RunProtocol& protocol) const {
  if (live_) protocol.frames_in_range = static_cast<int>(run.frames.size());
}

RunResult RunInput::play(Slam& slam, const PlayHooks& hooks, const InterruptCatcher& interrupt) {
  if (live_) return play_with_progress(slam, *live_->frames, hooks, interrupt, options_.quiet);
  RunResult run = play_with_progress(slam, *scaled_.recording, hooks, interrupt, options_.quiet);
  for (const MotionWarning& warning : run.motion_warnings) {
    run.warnings.push_back(to_text(warning, motion_source(options_.recording, options_.open, warning.sensor)));
  }
  return run;
}

std::string RunInput::report() {
  return live_ ? live_->report() : "";
}

}  // namespace byre::cli
