#pragma once

#include "byre/cli/finish_report.h"
#include "byre/dataset/recording.h"
#include "byre/features/extract.h"
#include "byre/map/map_file.h"
#include "byre/session/session.h"

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace byre::cli {

// Where mapping runs, and how fast frames are fed.
//   same_thread  on the frame thread ("inline"), frames as fast as possible
//   paced        on workers, taken over kPacedLatency frames later, corrections of the whole map
//                kPacedCorrectionLatency and searches in an offline map kPacedSearchLatency; frames as fast as
//                possible: repeatable
//   live         on workers, taken over when ready, frames at the recording's own time stamps; none is dropped
enum class Pace : std::uint8_t { same_thread, paced, live };

// As on the command line.
std::string_view name_of(Pace pace);
std::string_view name_of(OfflinePolicy policy);

inline constexpr int kPacedLatency = 4;             // frames
inline constexpr int kPacedCorrectionLatency = 40;  // frames
inline constexpr int kPacedSearchLatency = 6;       // frames

struct MapRunOptions {
  Pace pace = Pace::paced;
  ExtractOptions extract;
  SessionOptions session;
  bool self_calibrate = true;               // refine the calibration given from what is mapped
  std::optional<RefinedCalibration> known;  // what the cameras are known to be by now, of which the readout time alone
                                            // is refined; empty: what the offline map knows, if anything
  SelfCalibrationOptions self_calibration;
  FinishOptions finish;
  std::optional<Vocabulary> vocabulary;  // to recognise places with; without it no loop is closed, nor the map finished
  std::shared_ptr<const OfflineMap> offline;  // a mission on this map; what is mapped beside it is not finished
};

// Wall time of a frame's stages, seconds. All but decode are spent one after the other on the frame thread.
struct StageSeconds {
  double decode = 0.0;  // ahead, in a thread of its own; not in total
  double rectify = 0.0;
  double extract = 0.0;
  double stereo = 0.0;  // or reading depths
  double track = 0.0;
  double map = 0.0;         // windows, deltas, new points, and jobs where they run on this thread
  double map_submit = 0.0;  // of map: handing jobs to the executor, so the whole job where it runs on this thread
  double total = 0.0;       // from the images in memory to the report
};

struct MappedFrame {
  Timestamp time{};
  bool has_right = false;
  bool has_depth = false;
  std::optional<FrameReport> report;  // empty when its images could not be read and it was left out
  StageSeconds seconds;
  int keyframes = 0;       // of the map after it
  int points = 0;          // of the map after it
  double memory_mb = 0.0;  // resident, of the whole program
};

struct MapRun {
  std::vector<MappedFrame> frames;                // one for each frame of the recording, fewer when the run was stopped
  Trajectory causal;                              // poses as published when their frames came
  Trajectory final;                               // as recomputed after the last frame
  Trajectory odometry;                            // the smooth poses as published, in a frame of their own
  Map map{Origin::offline};                       // as it is kept; of the keyframes made, others were found redundant
  std::optional<RefinedCalibration> calibration;  // by which the map lies, where it was refined
  std::optional<Finishing> finishing;             // empty when it was left out: stopped before, or without a vocabulary
  std::optional<double> mission_finishing_seconds;  // of a mission, of adjusting its online map as a whole
  std::vector<double> job_seconds;                  // wall time of each mapping job
  std::vector<std::string> warnings;                // of the recording
  std::vector<double> lateness;  // live: seconds by which frames were fed too late, of those that were
  double wall_seconds = 0.0;     // of it all
};

// What can be seen of a run right after a frame: valid for the time of the call.
struct RunView {
  const ImageFrame& images;
  const MappedFrame& frame;
  const Session& session;
};

struct MapRunHooks {
  std::function<bool()> should_stop;                                    // asked before each frame, and when finishing
  std::function<void(int done, const MappedFrame& frame)> after_frame;  // not in the frame's time
  std::function<void(const RunView& view)> look;  // unless empty, after each frame that could be read; not in its time
  std::function<void(const Map& online, const std::optional<RefinedCalibration>& calibration)>
      offer_map;  // unless empty, after each frame from the first with a pose on
  std::function<void(const char* step)> before_finishing_step;
};

// Maps a recording from its first to its last frame, and finishes the map. Frames whose images cannot be read
// are left out. Goes on with the map before, an online copy, if there is one: it needs the vocabulary's words, and
// options a vocabulary. Throws InputError when the calibration cannot be rectified.
MapRun run_map(Recording& recording, const MapRunOptions& options, const MapRunHooks& hooks,
               std::optional<Map> before = {});

}  // namespace byre::cli
