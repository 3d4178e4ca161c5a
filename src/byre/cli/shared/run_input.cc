#include "byre/cli/shared/run_input.h"

#include "byre/base/report_row.h"
#include "byre/calibration_file.h"
#include "byre/cli/shared/progress.h"
#include "byre/geometry/baseline.h"
#include "byre/io/recording/motion_files.h"
#include "byre/playback/report/recording_report.h"
#include "byre/playback/scaled_recording.h"

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

void require_one_input(const std::filesystem::path& recording, const LiveOptions& live, const OpenOptions& open) {
  if (recording.empty() && !live.is_wanted()) {
    throw CLI::ValidationError("RECORDING", "give a recording, or cameras (--live /dev/video0)");
  }
  if (live.is_wanted() && !open.calibration) {
    throw CLI::ValidationError("--live", "needs the calibration of the cameras (--calibration FILE)");
  }
}

RunInput::RunInput(Choice choice) : choice_(std::move(choice)) {
  if (!choice_.live.is_wanted()) {
    scaled_ = open_scaled(choice_.recording, choice_.range, choice_.open, choice_.has_metric_map);
    if (!choice_.quiet) show_warnings(std::cerr, scaled_.recording->warnings());
    return;
  }
  const std::filesystem::path& file = *choice_.open.calibration;
  const auto on_note = [](const std::string& note) {
    show_warnings(std::cerr, {note});
  };  // shown even if quiet, as it needs attention
  const Calibration calibration = with_checked_baseline(read_calibration(file, choice_.open.right_calibration),
                                                        choice_.open.baseline, file.string(), "--baseline ");
  live_ =
      open_live(choice_.live, scaled_calibration(calibration, choice_.has_metric_map, scaled_), file.string(), on_note);
}

const Calibration& RunInput::calibration() const {
  return live_ ? live_->frames->calibration() : scaled_.recording->calibration();
}

void RunInput::show_check() const {
  if (live_ || choice_.quiet) return;
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
    protocol.recording = choice_.live.name();
    protocol.format.reset();
    protocol.camera = calibration().right ? CameraChoice::stereo : CameraChoice::left;
    return;
  }
  protocol.recording = choice_.recording.string();
  protocol.format = guess_format(choice_.recording);
  protocol.camera = camera_of(*scaled_.recording, choice_.open);
  protocol.range = choice_.range;
  protocol.frames_in_range = scaled_.recording->size();
  protocol.times = scaled_.recording->time_corrections();
}

std::string RunInput::name() const {
  return live_ ? kLiveName : source_name(choice_.recording);
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
  if (live_) return play_with_progress(slam, *live_->frames, hooks, interrupt, choice_.quiet);
  RunResult run = play_with_progress(slam, *scaled_.recording, hooks, interrupt, choice_.quiet);
  for (const MotionWarning& warning : run.motion_warnings) {
    run.warnings.push_back(to_text(warning, motion_source(choice_.recording, choice_.open, warning.sensor)));
  }
  return run;
}

std::string RunInput::report() {
  return live_ ? live_->report() : "";
}

}  // namespace byre::cli
