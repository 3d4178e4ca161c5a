#pragma once

#include "byre/cli/shared/live_input.h"
#include "byre/cli/shared/progress.h"
#include "byre/cli/shared/view_run.h"
#include "byre/map/map_file.h"
#include "byre/playback/report/run_report.h"
#include "byre/playback/scaled_recording.h"
#include "byre/slam.h"

#include <filesystem>
#include <memory>
#include <optional>
#include <string>

namespace byre::cli {

// Options of commands that run SLAM on a recording or on live cameras: "byre map" and "byre run".
struct RunInputOptions {
  std::filesystem::path recording;  // empty for live cameras
  LiveOptions live;
  std::optional<std::filesystem::path> trajectory;
  std::optional<std::filesystem::path> causal_trajectory;
  std::optional<std::filesystem::path> stats;
  std::optional<std::filesystem::path> vocabulary;  // empty: the vocabulary installed with byre
  FrameRange range;
  OpenOptions open;
  ExtrinsicsArguments extrinsics;
  MethodArguments method;
  TrajectoryFormat trajectory_format = TrajectoryFormat::tum;
  std::optional<std::filesystem::path> record;  // bag of ROS 2 messages
  bool record_images = false;
  bool quiet = false;
  bool verbose = false;

  // Options of a Slam on frames of this name.
  SlamOptions slam(const std::string& name) const;
};

// The options must outlive the parsing of the command line.

// RECORDING
void declare_recording_argument(CLI::App& command, RunInputOptions& options);

// Options of the input: cameras, calibration, extrinsics, frame range, live cameras and pace.
void declare_run_input(CLI::App& command, RunInputOptions& options);

// Declare these last: format of trajectories, --record, options of the method, --quiet and --verbose.
void declare_run_output(CLI::App& command, RunInputOptions& options);

// Throws CLI::ValidationError for an empty range, and unless there is either a recording, or live cameras with a
// calibration.
void require_consistent_input(const RunInputOptions& options);

// Frames of a run: a recording or live cameras.
class RunInput {
 public:
  // has_metric_map: a map provides the scale for one camera. Throws InputError if the recording or the cameras cannot
  // be opened.
  RunInput(const RunInputOptions& options, bool has_metric_map);

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
  RunInputOptions options_;  // constant after construction
  ScaledRecording scaled_;
  std::optional<LiveInput> live_;
};

}  // namespace byre::cli
