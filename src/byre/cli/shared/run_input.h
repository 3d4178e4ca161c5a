#pragma once

#include "byre/cli/shared/live_input.h"
#include "byre/cli/shared/progress.h"
#include "byre/cli/shared/view_run.h"
#include "byre/map/map_file.h"
#include "byre/playback/report/run_report.h"
#include "byre/playback/scaled_recording.h"

#include <filesystem>
#include <memory>
#include <optional>
#include <string>

namespace byre::cli {

// Throws CLI::ValidationError unless there is either a recording, or live cameras with a calibration.
void require_one_input(const std::filesystem::path& recording, const LiveOptions& live, const OpenOptions& open);

// Frames of a run: a recording or live cameras.
class RunInput {
 public:
  struct Choice {
    std::filesystem::path recording;
    FrameRange range;
    OpenOptions open;
    LiveOptions live;
    bool has_metric_map = false;  // a map provides the scale for one camera
    bool quiet = false;           // suppresses warnings
  };

  // Throws InputError if the recording or the cameras cannot be opened.
  explicit RunInput(Choice choice);

  const ScaledRecording& scaled() const { return scaled_; }  // without a recording for live cameras
  const Calibration& calibration() const;

  // Prints a summary of the recording and its problems before the run.
  void show_check() const;
  // Fills in the source of frames.
  void describe(RunProtocol& protocol) const;
  std::string name() const;  // in maps and for the viewer
  // Description for the viewer.
  WatchedRun watched(const std::optional<std::filesystem::path>& map, std::shared_ptr<const OfflineMap> offline) const;

  // play_with_progress on its frames.
  RunResult play(Slam& slam, const PlayHooks& hooks, const InterruptCatcher& interrupt);
  // Adds the number of frames of live cameras, known only after the run.
  void note_frames(const RunResult& run, RunProtocol& protocol) const;
  // Report rows about live cameras; empty for recordings. Call it once, after the run.
  std::string report();

 private:
  Choice choice_;  // constant after construction
  ScaledRecording scaled_;
  std::optional<LiveInput> live_;
};

}  // namespace byre::cli
