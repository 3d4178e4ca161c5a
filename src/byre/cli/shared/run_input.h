#pragma once

#include "byre/assessment/run_report.h"
#include "byre/camera/live_frames.h"
#include "byre/cli/shared/camera_options.h"
#include "byre/cli/shared/interrupt.h"
#include "byre/cli/shared/view_run.h"
#include "byre/map/map_file.h"
#include "byre/playback/scaled_recording.h"

#include <filesystem>
#include <memory>
#include <optional>
#include <string>

namespace CLI {
class App;
class Option;
}  // namespace CLI

namespace byre::cli {

// --live and what goes with it: cameras in place of a recording.
struct LiveOptions {
  CameraOptions cameras;
  std::optional<double> duration_s;

  bool is_wanted() const { return !cameras.devices.empty(); }
};

// Declares --live, --duration and the options of cameras. What is only of recordings, declared before, excludes it. The
// options must outlive the parsing of the command line.
void declare_live_options(CLI::App& command, LiveOptions& options);

// Throws CLI::ValidationError unless there is a recording or live cameras with their calibration, and not both.
void require_one_input(const std::filesystem::path& recording, const LiveOptions& live, const OpenOptions& open);

// What a run takes its frames from, a recording or live cameras.
class RunInput {
 public:
  struct Choice {
    std::filesystem::path recording;
    FrameRange range;
    OpenOptions open;
    LiveOptions live;
    bool has_metric_map = false;  // it tells one camera the scale
    bool quiet = false;           // no warnings are shown
  };

  // Throws InputError when the recording or the cameras cannot be opened.
  explicit RunInput(Choice choice);

  const ScaledRecording& scaled() const { return scaled_; }  // without a recording where cameras are live
  const Calibration& calibration() const;

  // What is known beforehand: of a recording its summary, and what would spoil the run.
  void show_check() const;
  // All that a protocol says of where frames come from.
  void describe(MapProtocol& protocol) const;
  // What a map says of it; of live cameras times only once note_times has them.
  SourceRecording source() const;
  // What the viewer tells of it.
  WatchedRun watched(const std::optional<std::filesystem::path>& map, std::shared_ptr<const OfflineMap> offline) const;

  // run_with_progress over its frames.
  MapRun run(const EngineOptions& options, const MapRunHooks& hooks, const InterruptCatcher& interrupt,
             std::optional<Map> before = {});
  // What is known of live cameras after the run alone; of a recording it was known before.
  void note_times(const MapRun& run, SourceRecording& source) const;
  void note_frames(const MapRun& run, MapProtocol& protocol) const;
  // What came of the cameras, as rows of the report; of a recording nothing. To be asked once, after the run.
  std::string report();

 private:
  Choice choice_;  // constant after construction
  ScaledRecording scaled_;
  std::unique_ptr<LiveFrames> live_;
};

}  // namespace byre::cli
