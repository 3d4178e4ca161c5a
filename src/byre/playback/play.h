#pragma once

#include "byre/input_error.h"
#include "byre/plan_registration.h"
#include "byre/recording.h"
#include "byre/slam/system/slam_impl.h"

#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace byre {

class FrameSource;

struct PlayedFrame {
  Timestamp time{};
  bool has_right = false;
  bool has_depth = false;
  std::optional<FrameReport> report;  // empty if skipped: unreadable images, or a fault that Slam drops
  StageSeconds seconds;
  int keyframes = 0;       // keyframes of the map after the frame
  int points = 0;          // points of the map after the frame
  double memory_mb = 0.0;  // resident memory of the process
};

// Estimates from wheels and inertial sensors.
struct MotionEstimates {
  bool has_samples = false;  // whether wheels or a gyroscope gave samples
  std::optional<WheelCalibration> wheels;
  std::optional<GyroscopeCalibration> gyroscope;
  double time_offset = 0.0;                  // delay of wheel stamps relative to the camera, seconds
  int slips = 0;                             // number of rejections for wheel slip
  bool has_calibration_changed = false;      // motions contradict the initial wheel extrinsics
  OdometryCalibration calibration_to_store;  // extrinsics to save for later runs
  int stops = 0;                             // standstills confirmed by the accelerometer
  double standstill_s = 0.0;                 // duration of the standstills, seconds
  int tilts_applied = 0;                     // bridged frames with roll and pitch from the accelerometer
  std::optional<double> scale_sigma;         // relative standard deviation of a scale measured by wheels or tags only
  bool is_scaled_by_tags = false;
  int filled_poses = 0;  // frames whose final pose is filled in by wheel odometry
};

struct RunResult {
  std::vector<PlayedFrame> frames;                // one per frame of the recording; fewer if stopped
  Trajectory causal;                              // poses as published at their frames
  Trajectory final;                               // poses after the last frame, with all corrections
  Trajectory odometry;                            // smooth odometry as published, in its own frame
  StoredMap stored;                               // map to save, without redundant keyframes
  std::shared_ptr<const OfflineMap> offline;      // offline map of a mission; null otherwise
  std::optional<RefinedCalibration> calibration;  // calibration of the map; empty unless refined
  std::optional<double> row_error;        // row error of the calibration in use, pixels; empty without stereo pairs
  std::optional<FinishResult> finishing;  // finishing of a map; empty if skipped, see SlamImpl::finish
  std::vector<Timestamp> not_joined;      // frames tracked in separate submaps that were not joined with the map
  int located_afterwards = 0;             // frames without a causal pose that were located in the finished map
  std::optional<double> mission_finishing_seconds;  // wall time of adjusting a mission's online map
  std::vector<double> job_seconds;                  // wall time of each mapping job
  MotionEstimates motion;
  bool is_metric = true;  // whether map and final poses are in metres
  // Damage of the offline map's file that ended the mission, see SlamImpl::map_damage.
  std::optional<InputError> map_damage;
  std::vector<std::string> warnings;           // warnings of the recording
  std::vector<MotionWarning> motion_warnings;  // faults of motion inputs and tags
  std::vector<double> lateness;                // delays of late frames in a live run, seconds
  double wall_seconds = 0.0;                   // wall time of the whole run
};

// State of a run after a frame; valid during a call.
struct RunView {
  const ImageFrame& images;
  const PlayedFrame& frame;
  const Session& session;
};

struct PlayHooks {
  std::function<bool()> should_stop;                                    // called before each frame and while finishing
  std::function<void(int done, const PlayedFrame& frame)> after_frame;  // not part of the frame's time
  std::function<void(const RunView& view)> on_frame;        // optional; after each readable frame, not part of its time
  std::function<void(const SlamImpl& slam)> on_map_update;  // optional; after each frame from the first pose on
  std::function<void(const char* step)> before_finishing_step;
};

// Feeds all frames and motion samples of a source to slam, then finishes it. Skips unreadable frames. The map moves to
// the result; slam is finished and without a map afterwards.
RunResult play(Slam& slam, FrameSource& frames, const PlayHooks& hooks);
// Recordings are played as fast as possible, at live pace in real time.
RunResult play(Slam& slam, Recording& recording, const PlayHooks& hooks);

// Transforms poses from the map to its floor plan, and adds the covariance of the registration. Verdicts are still
// those in the map, as the registration does not affect navigation.
Trajectory on_plan(Trajectory trajectory, const PlanRegistration& registration);
PlayedFrame on_plan(PlayedFrame frame, const PlanRegistration& registration);
RunResult on_plan(RunResult run, const PlanRegistration& registration);  // without odometry and the map itself

}  // namespace byre
