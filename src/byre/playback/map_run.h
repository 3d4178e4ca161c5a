#pragma once

#include "byre/input_error.h"
#include "byre/recording.h"
#include "byre/system/engine.h"

#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace byre {

struct MappedFrame {
  Timestamp time{};
  bool has_right = false;
  bool has_depth = false;
  std::optional<FrameReport> report;  // empty when its images could not be read and it was left out
  StageSeconds seconds;
  int keyframes = 0;       // keyframes of the map after the frame
  int points = 0;          // points of the map after the frame
  double memory_mb = 0.0;  // resident memory of the whole program
};

// What was found out of what told the robot's motion.
struct ToldMotion {
  bool is_told = false;  // by wheels or a gyroscope
  std::optional<WheelMounting> wheels;
  std::optional<GyroscopeMounting> gyroscope;
  double time_offset = 0.0;            // seconds that wheels stamp later than the camera
  int slips = 0;                       // times that wheels were left out
  bool is_mounted_otherwise = false;   // wheels, than when the map was made
  KnownMounting to_keep;               // for the next drive
  int stops = 0;                       // times that the body stood still, as accelerations show too
  double stood_s = 0.0;                // seconds that it did
  int tilts_held = 0;                  // bridged frames whose roll and pitch accelerations held
  std::optional<double> metres_sigma;  // standard deviation of metres by wheels alone, as a share
  int led_afterwards = 0;              // final poses of frames that had none, where wheels led from those that had
};

struct MapRun {
  std::vector<MappedFrame> frames;  // one for each frame of the recording, fewer when the run was stopped
  Trajectory causal;                // poses as published when their frames came
  Trajectory final;                 // poses as recomputed after the last frame
  Trajectory odometry;              // the smooth poses as published, in a frame of their own
  Map map{Origin::offline};         // map as it is kept; of the keyframes made, others were found redundant
  std::optional<RefinedCalibration> calibration;  // calibration that the map lies by, where it was refined
  std::optional<double> row_error;  // row error of the calibration in use, pixels (CommonRowError); empty without pairs
  std::optional<Finishing> finishing;  // empty when it was left out: stopped before, or without a vocabulary
  std::optional<double> mission_finishing_seconds;  // wall time of adjusting a mission's online map as a whole
  std::vector<double> job_seconds;                  // wall time of each mapping job
  ToldMotion told;
  bool is_metric = true;  // lengths of the map and of final poses are metres
  // Damage of the offline map's file that ended the mission, see Engine::map_damage.
  std::optional<InputError> map_damage;
  std::vector<std::string> warnings;           // warnings of the recording
  std::vector<MotionWarning> motion_warnings;  // faults of wheels, gyroscope and accelerometer
  std::vector<double> lateness;                // seconds by which late frames were fed too late, in a live run
  double wall_seconds = 0.0;                   // wall time of the whole run
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
  // Unless empty, after each frame from the first with a pose on.
  std::function<void(const Map& online, const KeptWithMap& kept)> offer_map;
  std::function<void(const char* step)> before_finishing_step;
};

// Maps a recording from its first to its last frame, and finishes the map. Frames whose images cannot be read
// are left out. Goes on with the map before, an online copy, if there is one: it needs the vocabulary's words, and
// options a vocabulary. Throws InputError when the calibration cannot be rectified.
MapRun run_map(Recording& recording, const EngineOptions& options, const MapRunHooks& hooks,
               std::optional<Map> before = {});

}  // namespace byre
