#pragma once

#include "byre/base/executor.h"
#include "byre/frame_report.h"
#include "byre/slam/frame/dirt_detector.h"
#include "byre/slam/frame/frame_budget.h"
#include "byre/slam/frame/health.h"
#include "byre/slam/frame/image_monitor.h"
#include "byre/slam/frame/state.h"
#include "byre/slam/localisation/offline_tracker.h"
#include "byre/slam/localisation/place_bounds.h"
#include "byre/slam/localisation/place_search.h"
#include "byre/slam/localisation/pose_filter.h"
#include "byre/slam/mapping/keyframe_policy.h"
#include "byre/slam/mapping/mapper.h"
#include "byre/slam/mapping/rolling_shutter_corrector.h"
#include "byre/slam/session/frame_summary.h"
#include "byre/slam/session/session_options.h"
#include "byre/slam/session/tracker.h"

#include <memory>
#include <optional>
#include <utility>
#include <vector>

namespace byre {

// Executors of jobs. local: mapping around new keyframes. global: corrections of the whole map; in a mission on an
// offline map, place searches.
struct SessionExecutors {
  // NOLINTNEXTLINE(google-explicit-constructor): a session without loop closing needs one executor
  SessionExecutors(std::unique_ptr<Executor> local_executor,
                   std::unique_ptr<Executor> global_executor = make_inline_executor(),
                   std::unique_ptr<Executor> calibration_executor = make_inline_executor(),
                   std::unique_ptr<Executor> reading_executor = make_inline_executor())
      : local(std::move(local_executor)),
        global(std::move(global_executor)),
        calibration(std::move(calibration_executor)),
        reading(std::move(reading_executor)) {}

  std::unique_ptr<Executor> local;
  std::unique_ptr<Executor> global;
  std::unique_ptr<Executor> calibration;  // calibration of a mission's cameras
  std::unique_ptr<Executor> reading;      // jobs that read the map, which is constant meanwhile
};

// Tracks frames in order of time and maps the scene. The tracker localises each frame, the mapper makes keyframes of
// some, and the pose filter holds the pose. Call every method from one thread; only executors use others.
class Session {
 public:
  // A vocabulary enables place recognition: loop closing and relocalisation. An offline map makes the session a
  // mission: it localises in that map, and its poses are in the map's frame.
  Session(const Rig& rig, const SessionOptions& options, SessionExecutors executors,
          std::optional<Vocabulary> vocabulary = {}, std::shared_ptr<const OfflineMap> offline = nullptr);

  // Sets the sources of measured motion between keyframes and of the robot's reach. Call it before the first frame.
  void set_odometry(OdometryQuery odometry, ReachQuery reach) {
    mapper_.set_odometry(std::move(odometry));
    pose_filter_.set_odometry(std::move(reach));
  }

  // Continues an online map of another recording: the session is lost until it relocalises in it, and extends it. Call
  // it before the first frame. Precondition: the keyframes have words of the session's vocabulary.
  void continue_map(Map online);

  // Refines the calibration that frames are rectified by, and the readout time of a rolling shutter. Call it before the
  // first frame.
  void refine_calibration(const Calibration& given, const SelfCalibrationOptions& options);

  // Refines the readout time alone; keeps the rest of the given calibration. Call it before the first frame.
  void refine_readout(const RefinedCalibration& known);

  // The refined calibration; empty before the first refinement.
  std::optional<RefinedCalibration> self_calibration() const;

  // Limits localisation in the offline map to the hint until it expires.
  void set_initial_pose(const PoseHint& hint) {
    hint_.set_hint(hint);
    trusted_place_.forget();
  }

  // While paused, frames are tracked and nothing is added to the map.
  void pause_mapping(bool is_paused) { is_mapping_paused_ = is_paused; }
  bool is_mapping_paused() const { return is_mapping_paused_; }

  // Tilt of the body at the next frame, measured by accelerations; empty: unknown. Constrains dead reckoning.
  void set_tilt(const std::optional<BodyTilt>& tilt) { pose_filter_.set_tilt(tilt); }
  int tilts_applied() const { return pose_filter_.tilts_applied(); }  // number of frames that a tilt constrained
  // motion: of the body since the last frame; empty: unknown. budget: time limit of the frame; nullptr: none. The
  // caller calls its begin() before and its end() after.
  FrameReport process(const Frame& rectified, const std::optional<BodyMotion>& motion = {},
                      FrameBudget* budget = nullptr);

  // Ends a running correction of the whole map early, with its present result.
  void finish_early() { mapper_.finish_early(); }

  // Applies the results of running jobs. Call it once, after the last frame.
  void finish();

  // Last loop search and adjustment of the whole map. Call it after finish().
  FinishReport finish_map(const FinishHooks& hooks);
  Map take_online() { return mapper_.take_online(); }  // see Mapper

  // Scales all lengths. Call it after finish_map().
  void rescale(double factor) { pose_filter_.apply_length_changes(mapper_.rescale(factor)); }

  // Adjusts the whole online map around the fixed offline map. Call it after finish().
  void finish_mission(const FinishHooks& hooks);

  MapView map() const { return mapper_.map(); }

  // Map points matched in the last frame; empty without a pose.
  const std::vector<SeenPoint>& seen_points() const { return seen_; }

  // Loops found so far, with the measurement at that time.
  const std::vector<LoopEdge>& loops() const { return mapper_.loops(); }

  // Poses world_from_body of all frames with a pose, by the present poses of their keyframes.
  Trajectory final_trajectory() const;

 private:
  // Result of tracking or localising a frame.
  struct Located {
    std::optional<HybridTrack> track;
    std::vector<HybridTrack> elsewhere;  // other places that show the frame
    bool is_relocalised = false;
    bool is_by_hint = false;     // the search was limited to a hint
    bool begins_submap = false;  // the frame became the first keyframe of a submap
    TwoViewFailure start_failure = TwoViewFailure::none;
    DistrustReason refused = DistrustReason::none;  // why a place that shows the frame was rejected
  };

  void apply_finished_jobs(FrameReport& report);
  void apply_place_search(FrameReport& report);
  bool apply_camera_change();
  void apply_rig_rotation(const RigRotation& turn);
  InputFrame input_of(const Frame& rectified, const std::optional<BodyMotion>& motion);
  void sort_by_log_odds(std::vector<HybridTrack>& places, const Frame& frame);
  Located locate(const InputFrame& input);
  bool may_begin_submap(const InputFrame& input) const;
  Located begin_submap(const Frame& frame);
  void remember(const InputFrame& input, const Located& located, FrameReport& report);
  void update_dirt_mask(const InputFrame& input, const Located& located, FrameReport& report);
  void extend_map(const InputFrame& input, const HybridTrack& track, FrameReport& report);
  bool may_add_keyframe(const InputFrame& input, const HybridTrack& track);
  bool search_loop(const Frame& frame, bool keyframe_added);
  void lose_pose(ImageFault fault, FrameReport& report);
  void note_quality(const FrameReport& report);

  SessionOptions options_;  // constant after construction

  // Owned by the calling thread.
  Rig rig_;  // rig of the present frame
  Mapper mapper_;
  Tracker tracker_;
  std::optional<OfflineTracker> mission_;
  ActiveHint hint_;
  PoseFilter pose_filter_;
  KeyframePolicy keyframe_policy_;
  ImageMonitor image_monitor_;
  FaultLatches fault_latches_;
  DirtDetector dirt_detector_;
  RollingShutterCorrector rolling_shutter_;
  State state_ = State::initialising;
  std::optional<Timestamp> first_frame_;
  TrustedPlace trusted_place_;
  bool is_error_reported_ = false;  // a navigation error was reported
  bool is_mapping_paused_ = false;
  std::vector<SeenPoint> seen_;  // points of the last frame
};

}  // namespace byre
