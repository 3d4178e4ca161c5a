#pragma once

#include "byre/base/executor.h"
#include "byre/frame_report.h"
#include "byre/slam/session/robot_state.h"
#include "byre/slam/session/session_options.h"
#include "byre/slam/session/step.h"

#include <memory>
#include <optional>
#include <utility>
#include <vector>

namespace byre {

// Executors of jobs. local: mapping around new keyframes. global: jobs on the whole map; in a mission on an offline
// map, place searches. calibration: calibration of a mission's cameras. index: words of new keyframes, and loop
// searches.
struct SessionExecutors {
  // NOLINTNEXTLINE(google-explicit-constructor): a session without loop closing needs one executor
  SessionExecutors(std::unique_ptr<Executor> local_executor,
                   std::unique_ptr<Executor> global_executor = make_inline_executor(),
                   std::unique_ptr<Executor> calibration_executor = make_inline_executor(),
                   std::unique_ptr<Executor> index_executor = make_inline_executor())
      : local(std::move(local_executor)),
        global(std::move(global_executor)),
        calibration(std::move(calibration_executor)),
        index(std::move(index_executor)) {}

  Executor& of(JobKind kind) const;

  std::unique_ptr<Executor> local;
  std::unique_ptr<Executor> global;
  std::unique_ptr<Executor> calibration;
  std::unique_ptr<Executor> index;
};

// Runs step() frame by frame, and its jobs on executors. Call every method from one thread; only executors use others.
class Session {
 public:
  // See RobotState.
  Session(const Rig& rig, const SessionOptions& options, SessionExecutors executors,
          std::optional<Vocabulary> vocabulary = {}, std::shared_ptr<const OfflineMap> offline = nullptr)
      : options_(options),
        state_(rig, options, std::move(vocabulary), std::move(offline)),
        executors_(std::move(executors)) {}

  // Sets the sources of measured motion between keyframes and of the robot's reach. Call it before the first frame.
  void set_odometry(OdometryQuery odometry, ReachQuery reach) {
    state_.mapper.set_odometry(std::move(odometry));
    state_.pose_filter.set_odometry(std::move(reach));
  }

  void require_odometry() { state_.mapper.require_odometry(); }  // see Mapper

  // Continues an online map of another recording: the session is lost until it relocalises in it, and extends it. Call
  // it before the first frame. Precondition: the keyframes have words of the session's vocabulary.
  void continue_map(MapGraph online);

  // Refines the calibration that frames are rectified by, and the readout time of a rolling shutter. Call it before the
  // first frame.
  void refine_calibration(const Calibration& given, const SelfCalibrationOptions& options);

  // Refines the readout time alone; keeps the rest of the given calibration. Call it before the first frame.
  void refine_readout(const RefinedCalibration& known);

  // The refined calibration; empty before the first refinement.
  std::optional<RefinedCalibration> self_calibration() const;

  // Cameras as calibrated by another session; its next frame may be this session's first. The session began with
  // known.rig. Call it before the first frame.
  struct KnownCameras {
    Rig rig;
    std::optional<MissionCalibrator> calibrator;
    RollingShutterCorrector rolling_shutter;
  };
  KnownCameras known_cameras() const;
  void continue_cameras(KnownCameras known);

  // Log-odds of the present place in the offline map against look-alikes; kNoRivals without a pose tracked there.
  double log_odds_of_place() const;

  // Limits localisation in the offline map to the hint until it expires.
  void set_initial_pose(const PoseHint& hint) {
    state_.hint.set_hint(hint);
    state_.trusted_place.forget();
  }

  // While paused, frames are tracked and nothing is added to the map.
  void pause_mapping(bool is_paused) { state_.is_mapping_paused = is_paused; }
  bool is_mapping_paused() const { return state_.is_mapping_paused; }

  // Tilt of the body at the next frame, measured by accelerations; empty: unknown. Constrains dead reckoning.
  void set_tilt(const std::optional<BodyTilt>& tilt) { tilt_ = tilt; }
  int tilts_applied() const { return state_.pose_filter.tilts_applied(); }  // frames that a tilt constrained
  // See StepInput.
  FrameReport process(const Frame& rectified, const std::optional<BodyMotion>& motion = {},
                      FrameBudget* budget = nullptr);

  // Ends a running job on the whole map early, with its present result.
  bool is_scaled_by_odometry() const { return state_.mapper.is_scaled_by_odometry(); }  // see Mapper
  bool contradicts_odometry() const { return state_.mapper.contradicts_odometry(); }    // see Mapper
  void finish_early() { state_.mapper.finish_early(); }

  // Applies the results of running jobs, and joins separate submaps. Call it once, after the last frame.
  void finish();

  // Last loop search and adjustment of the whole map. Call it after finish().
  FinishReport finish_map(const FinishHooks& hooks);
  MapGraph joined_online() const { return state_.mapper.joined_online(); }  // see Mapper
  MapGraph take_online() { return state_.mapper.take_online(); }            // see Mapper

  // Scales all lengths. Call it after finish_map().
  void rescale(double factor) { state_.pose_filter.apply_length_changes(state_.mapper.rescale(factor)); }

  // Pose world_from_body of a frame that was not located, in the finished map; empty if too few points agree.
  // predicted: by frames close in time. Call it after finish_map().
  std::optional<Pose> locate_in_finished_map(const Frame& rectified, const Pose& predicted);

  // Same without a prediction, accepted by the test of places.
  std::optional<Pose> find_in_finished_map(const Frame& rectified);

  // Adjusts the whole online map together with the part of the offline map in its view, and refines the trajectory by
  // both. The offline map does not change. Call it after finish().
  void finish_mission(const FinishHooks& hooks);

  const SessionOptions& options() const { return options_; }
  MapView map() const { return state_.map(); }

  // Map points matched in the last frame; empty without a pose.
  const std::vector<SeenPoint>& seen_points() const { return state_.seen; }

  // What a mission showed of the offline map's points, by number; empty without an offline map.
  std::vector<PointRecord> point_records() const {
    return state_.mission ? state_.mission->point_records() : std::vector<PointRecord>();
  }

  // Loops found so far, with the measurement at that time.
  const std::vector<LoopEdge>& loops() const { return state_.mapper.loops(); }

  // Times of frames in submaps that are not joined with the map.
  std::vector<Timestamp> frames_not_joined() const;

  // Poses world_from_body of all frames with a pose, by the present poses of their keyframes.
  Trajectory final_trajectory() const;

 private:
  void run(std::vector<JobRequest> requests);
  using Take = std::optional<FinishedJob> (Executor::*)();
  void deliver_results(Take take, Take take_local);

  SessionOptions options_;  // constant after construction
  RobotState state_;
  std::optional<BodyTilt> tilt_;
  SessionExecutors executors_;  // last member: its jobs end before the data that they share
};

}  // namespace byre
