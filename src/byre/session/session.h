#pragma once

#include "byre/features.h"
#include "byre/frame_report.h"
#include "byre/map/map_view.h"
#include "byre/session/calibrator.h"
#include "byre/session/executor.h"
#include "byre/session/global_lane.h"
#include "byre/session/mission.h"
#include "byre/session/mission_calibrator.h"
#include "byre/session/odometry.h"
#include "byre/session/place_search.h"
#include "byre/session/segments.h"
#include "byre/session/session_options.h"
#include "byre/session/shutter.h"
#include "byre/slam/finishing.h"
#include "byre/slam/focal_check.h"
#include "byre/slam/health.h"
#include "byre/slam/hindsight.h"
#include "byre/slam/initialisation.h"
#include "byre/slam/input_watch.h"
#include "byre/slam/keyframes.h"
#include "byre/slam/localisation.h"
#include "byre/slam/loop_closing.h"
#include "byre/slam/mapping.h"
#include "byre/slam/offline_map.h"
#include "byre/slam/state.h"
#include "byre/slam/tracking.h"

#include <memory>
#include <optional>
#include <utility>
#include <vector>

namespace byre {

// Where mapping runs: the neighbourhood of new keyframes, and corrections of the whole map; in a mission on an offline
// map the second looks for places in that instead.
struct Lanes {
  // NOLINTNEXTLINE(google-explicit-constructor): a session that is to close no loops needs one lane
  Lanes(std::unique_ptr<Executor> local_lane) : Lanes(std::move(local_lane), make_inline_executor()) {}
  Lanes(std::unique_ptr<Executor> local_lane, std::unique_ptr<Executor> global_lane)
      : Lanes(std::move(local_lane), std::move(global_lane), make_inline_executor()) {}
  Lanes(std::unique_ptr<Executor> local_lane, std::unique_ptr<Executor> global_lane,
        std::unique_ptr<Executor> calibration_lane)
      : local(std::move(local_lane)), global(std::move(global_lane)), calibration(std::move(calibration_lane)) {}

  std::unique_ptr<Executor> local;
  std::unique_ptr<Executor> global;
  std::unique_ptr<Executor> calibration;  // of a mission's cameras
};

// The one stateful object: give it frames in order of time. Call every method from one thread; only the executor has
// another.
class Session {
 public:
  // With a vocabulary the session recognises places: it closes loops, and finds itself again when lost.
  // With an offline map it is a mission on that: it finds itself in it, and its poses are in the map's frame.
  Session(const Rig& rig, const SessionOptions& options, Lanes lanes, std::optional<Vocabulary> vocabulary = {},
          std::shared_ptr<const OfflineMap> offline = nullptr);

  // Goes on with a map made before, of another recording: the session is lost until it finds itself in it, and what it
  // maps becomes part of it. Call it before the first frame, with a vocabulary whose words the keyframes have.
  void continue_map(Map online);

  // The calibration by which the frames are rectified may err, and is refined from what is seen, the readout time of a
  // rolling shutter with it. Call it before the first frame.
  void refine_calibration(const Calibration& given, const SelfCalibrationOptions& options);

  // Refines the readout time alone, and keeps all else as it is known to be. Call it before the first frame.
  void refine_readout(const RefinedCalibration& known);

  // What is known of the calibration by now; empty until it was refined.
  std::optional<RefinedCalibration> self_calibration() const;

  // last_from_body: how the body has moved since the last frame, where that is known.
  FrameReport process(const Frame& rectified, const std::optional<Pose>& last_from_body = {});

  // A correction of the whole map that is in flight ends soon, with what it has reached: for stopping early.
  void hurry() { global_.hurry(); }

  // Takes over what mapping still has to give. Call it once, after the last frame.
  void finish();

  // The last search for loops and adjustment of the whole map. Call it after finish().
  FinishReport finish_map(const FinishHooks& hooks);

  // Adjusts all that was mapped beside the offline map at once, around that. Call it after finish().
  void finish_mission(const FinishHooks& hooks);

  MapView map() const { return {mission_ ? &mission_->offline().map() : nullptr, online_}; }

  // Map points matched in the last frame; none when it had no pose.
  const std::vector<SeenPoint>& seen_points() const { return seen_; }

  // Places found again so far, each with what was seen of it then.
  const std::vector<LoopEdge>& loops() const { return loops_; }

  // Every frame that had a pose, recomputed from its keyframe as that one lies now. world_from_body.
  Trajectory final_trajectory() const;

 private:
  // Where a frame lay relative to a keyframe, so that it moves along when mapping moves that one.
  struct AnchoredPose {
    Timestamp time{};
    KeyframeId keyframe;
    Pose camera_from_keyframe;
    std::size_t segment = 0;
  };

  // A correction of the online map that waits for mapping to have nothing in flight.
  struct WaitingCorrection {
    Segments::Frame frame = Segments::kMapFrame;
    std::uint32_t first_keyframe = 0;  // number: of those in that frame, it and what came later
    Pose offline_from_online;
    CorrectionShape shape = CorrectionShape::spread;
  };

  // What a frame came to.
  struct Located {
    std::optional<HybridTrack> track;
    bool without_prediction = false;  // found from nothing
    bool is_new_segment = false;      // a first keyframe was made of it
    TwoViewFailure start_failure = TwoViewFailure::none;
  };

  void take_over_results(const std::optional<FinishedJob>& finished, FrameReport& report);
  void take_over(const FinishedJob& job);
  bool take_over_correction();
  void follow(const LengthChanges& changes);
  void recalibrate(const RefinedCalibration& refined);
  bool take_over_calibration();
  bool switch_camera();
  Frame corrected(const Frame& rectified) const;
  CameraMotion motion() const;
  bool take_over_readout();
  bool correct_online();
  void consider_place(const FoundPlace& found, FrameReport& report);
  bool is_refuted_by(const FoundPlace& found, const Agreement& agreement) const;
  void forget_places(const MapDelta& delta);
  void start_job();
  void index_place(KeyframeId id);
  bool look_for_loop(const Frame& frame, bool keyframe_added);
  void settle_loop(const LoopHypothesis& loop);

  bool may_be_led_back(Timestamp time) const;
  Located locate(const Frame& frame);
  const std::vector<PointId>& local_online_points();
  std::optional<HybridTrack> find_pose(const Frame& frame);
  std::optional<HybridTrack> track_from(const Frame& frame, const Pose& predicted, const std::vector<PointId>& online);
  std::optional<HybridTrack> relocalise(const Frame& frame);
  std::optional<HybridTrack> relocalise_offline(const Frame& frame);
  std::optional<HybridTrack> relocalise_online(const Frame& frame);
  bool may_begin_segment(const Frame& frame) const;
  void begin_stereo(const Frame& frame, Located& located);
  void begin_monocular(const Frame& frame, Located& located);
  void begin_segment(const Frame& frame);

  std::optional<Pose> offset_from_online(const HybridTrack& track) const;
  Pose without_change_of(const std::optional<Pose>& offset, const Pose& body) const;
  void remember(const Frame& frame, const HybridTrack& track, bool without_prediction, FrameReport& report);
  void remember_mission(const Frame& frame, const HybridTrack& track, double step, FrameReport& report);
  void begin_confirmation(const Frame& frame, const TrackedFrame& tracked);
  bool is_still_confirming(const HybridTrack& track);
  void look_for_proof(const HybridTrack& track);
  void lose_pose(ImageFault fault, FrameReport& report);
  void settle(const RememberedFrame& seen);
  bool may_map(const Frame& frame, const HybridTrack& track) const;
  void search_beside(const Frame& frame);
  void add_keyframe(const Frame& frame, const HybridTrack& track);
  KeyframeEvidence keyframe_evidence(const HybridTrack& track) const;
  void conclude(const Frame& frame, const Located& located, FrameReport& report);
  Matrix6 covariance_of(const TrackedFrame& tracked) const;
  void judge_calibration(HealthEvidence& evidence) const;
  Health health_of(const Frame& frame, const Located& located, const Matrix6& covariance) const;
  void tell_navigation_error(double seconds_without_pose, FrameReport& report);

  ImageFault image_fault(const Frame& frame) const;  // none where its condition is not known
  bool is_registered() const { return !segments_.empty() && segments_.frame() == Segments::kMapFrame; }
  bool is_in_present_frame(KeyframeId online) const { return segments_.frame(online) == segments_.frame(); }
  bool is_pose_confirmed() const { return confirmations_left_ == 0; }
  bool is_pose_proven() const { return proofs_left_ == 0; }
  std::uint32_t next_keyframe_number() const { return last_keyframe_ ? last_keyframe_->number + 1 : 0; }
  Pose camera_from_world(KeyframeId id) const;
  Pose last_camera_from_world() const;
  Pose body_pose(const Pose& camera_from_world) const { return inverse(rig_.body_from_camera * camera_from_world); }
  Pose camera_pose(const Pose& body) const { return inverse(body * rig_.body_from_camera); }
  Pose predict(Timestamp time) const;
  Vector6 velocity_to(Timestamp time, const Pose& camera_from_world) const;

  SessionOptions options_;  // constant after construction

  // Owned by the calling thread.
  Rig rig_;
  std::unique_ptr<Executor> calibration_executor_;       // until calibration begins
  std::optional<Calibrator> calibrator_;                 // of a session that maps
  std::optional<MissionCalibrator> mission_calibrator_;  // of a mission
  std::unique_ptr<Executor> executor_;
  GlobalLane global_;
  std::optional<Mission> mission_;     // on an offline map
  std::optional<PlaceSearch> search_;  // in that map
  std::optional<WaitingCorrection> waiting_correction_;
  Map online_{Origin::online};
  std::optional<MonocularInitialiser> initialiser_;  // of a rig without a baseline, until there is a map
  std::optional<PlaceIndex> places_;                 // of the online keyframes
  std::optional<LoopHypothesis> loop_;               // not confirmed yet
  int frames_since_loop_ = 0;                        // frames since one was confirmed
  std::vector<LoopEdge> loops_;                      // confirmed
  State state_ = State::initialising;
  Segments segments_;
  bool has_pose_ = false;                    // the last frame had one
  int confirmations_left_ = 0;               // frames until a pose found from nothing is believed,
  int proofs_left_ = 0;                      // and frames that see much of the map, until it is trusted
  std::size_t confirmed_end_ = 0;            // of anchored_, those before are of believed poses
  std::optional<Pose> offset_from_online_;   // of the last body pose, from where online points alone have it
  std::optional<Timestamp> last_confirmed_;  // time of the last believed pose in the reports' frame,
  std::optional<Timestamp> last_proven_;     // and of the last one beyond doubt
  std::optional<Timestamp> first_frame_;
  bool navigation_error_told_ = false;
  Odometry odometry_;
  Pose last_body_;  // of the last frame with a pose, as it was then
  std::optional<KeyframeId> last_keyframe_;
  std::uint32_t last_held_keyframe_ = 0;  // number of the newest online keyframe when offline points last held the pose
  std::optional<KeyframeId> online_reference_;  // whose points are looked for
  std::vector<PointId> local_points_;           // online ones around a keyframe,
  std::optional<KeyframeId> local_points_of_;   // this one; empty when the map has changed since
  int frames_since_keyframe_ = 0;
  int frames_without_depth_ = 0;         // since one had disparities, of a rig that gives them
  int last_inliers_ = 0;                 // in the last frame tracked
  int fresh_inliers_ = 0;                // in the first frame tracked with the present reference keyframe
  std::vector<SeenPoint> seen_;          // in the last frame
  std::optional<KeyframeId> reference_;  // of the last frame
  std::vector<KeyframeId> pending_;      // keyframes mapping has not worked on
  std::vector<AnchoredPose> anchored_;   // one per frame with a pose
  Hindsight hindsight_;                  // numbers are indices into those
  InputWatch input_watch_;
  InputEvidence input_;  // of the last frame
  FocalCheck focal_check_;
  Shutter shutter_;
  std::optional<RefinedCalibration> rolling_calibration_;  // as it was, where its readout time is refined
  double scene_depth_ = 1.0;                               // median of the points in the last frame
  bool is_focal_asked_ = false;                            // in the present frame
  Vector6 velocity_ = Vector6::Zero();  // of the camera, per second: exp_pose(velocity * dt) * last_camera_from_world
  std::optional<Pose> told_motion_ = Pose{};  // of the body since the last frame with a pose; empty: not known
};

}  // namespace byre
