#pragma once

#include "byre/features/rolling_shutter.h"
#include "byre/health.h"
#include "byre/map/plan/driven_ground.h"
#include "byre/slam/frame/hybrid_tracking.h"
#include "byre/slam/localisation/odometry.h"
#include "byre/slam/loops/odometry_motions.h"
#include "byre/slam/mapping/anchored_trajectory.h"
#include "byre/slam/places/place_hypothesis.h"
#include "byre/slam/tracking/motion_model.h"
#include "byre/slam/window/registration.h"

#include <optional>
#include <utility>
#include <vector>

namespace byre {

// Keyframe that a tracked frame's pose is stored relative to.
KeyframeId anchor_of(const HybridTrack& track);

// Pose state of the robot from frame to frame: updated by frames, measured motion and changes of the map. Reads maps,
// changes only itself. Called from the session's thread.
class PoseFilter {
 public:
  struct PoseQuality {
    Matrix6 covariance = Matrix6::Zero();           // see FrameReport
    Matrix6 odometry_covariance = Matrix6::Zero();  // see FrameReport
    Verdict verdict = Verdict::untrusted;
  };

  // on_offline_map: finds need confirmation, and sightings are kept.
  PoseFilter(const RegistrationOptions& registration, const DeferredRefinementOptions& deferred_refinement,
             const TrajectoryOptions& trajectory, bool on_offline_map)
      : registration_(registration), on_offline_map_(on_offline_map), trajectory_(deferred_refinement, trajectory) {}

  // Before the first frame.
  void set_odometry(ReachQuery reach) { reach_ = std::move(reach); }

  bool has_pose() const { return has_pose_; }  // in the last frame
  // Test of the pose's place in the offline map.
  const PlaceHypothesis& place() const { return place_; }
  // The pose was found by a search near a hint only, and is not accepted yet.
  bool is_by_hint() const { return is_by_hint_; }
  const AnchoredTrajectory& trajectory() const { return trajectory_; }
  const MotionModel& motion() const { return motion_; }
  const Odometry& odometry() const { return odometry_; }
  CameraMotion camera_motion() const { return {motion_.velocity(), scene_depth_}; }
  // Time of the last confirmed pose in the reports' frame.
  std::optional<Timestamp> last_confirmed() const { return last_confirmed_; }
  // Time of the last pose at an accepted place of the offline map.
  std::optional<Timestamp> last_accepted() const {
    return last_accepted_ ? std::optional(last_accepted_->time) : std::nullopt;
  }
  // The pose is lost, but measured motion since then is precise enough to match points from the predicted pose.
  bool can_return_by_odometry() const { return !has_pose_ && is_path_measured_ && is_odometry_accurate(); }
  // Measured motion from the last visual pose to the present one; empty if the last frame was tracked. Before there is
  // a map: motion since the first frame with measured motion, whose body frame becomes the map's.
  std::optional<BodyMotion> bridge() const { return has_pose_ ? std::nullopt : bridge_; }
  // Before there is a map: pose of the body at this frame in the frame of the future map, by measured motion.
  std::optional<Pose> start_by_odometry() const;
  const PoseQuality& quality_before() const { return quality_; }  // quality of the last visual pose
  Matrix6 covariance_of_bridge() const;  // covariance of the present pose in the map; precondition: there is a bridge
  // Covariance of the present submap's beginning in the map, moved to the present pose; adds to the covariance within
  // the submap.
  Matrix6 carried_covariance() const;
  // Covariance of the present pose by jumps of recent poses that neither the measured motion, nor the velocity, nor the
  // covariances explain: a pose before or after a jump is wrong. Decays within seconds of consistent motion.
  Matrix6 jump_covariance() const;
  // Covariance of the online map's place in the offline one, at the present pose: its covariance when offline points
  // last constrained it, plus the drift since then. length_sigma: share by which lengths by the cameras err.
  Matrix6 drift_covariance(double length_sigma) const;
  // Standard error of that place, metres. Infinite before offline points held a pose.
  double drift_sigma(double length_sigma) const;
  // Covariance of the odometry due to bridges that ended at found places; without the drift of visual odometry.
  Matrix6 bridged_odometry_covariance() const;
  std::optional<Timestamp> last_seen() const { return last_seen_; }  // time of the last visual pose
  // Whether the motion since the last visual pose contradicts a tracked pose, which then is a look-alike place. False
  // for a pose that continues the camera's motion. On an offline map: the robot's speed and the measured motion, see
  // log_odds_of_relocalisation. Without one: the measured motion alone, up to 30 s, after which the robot may have been
  // carried.
  bool is_unreachable(const Frame& frame, const HybridTrack& track, const Rig& rig, const MapView& map) const;
  // Whether a tracked pose in the offline map is farther from the last accepted one than the robot can have driven. Its
  // place is then tested like that of a kidnapped robot.
  bool is_jump(const Frame& frame, const HybridTrack& track, const Rig& rig, const MapView& map) const;
  // Prior log-odds that offline_from_online registers the present submap, by the measured motion up to its beginning. 0
  // if that motion is unknown.
  double log_odds_of_registration(const Pose& offline_from_online) const;

  // Prior log-odds of a place found without a prediction, by the motion since the last accepted pose.
  double log_odds_of_relocalisation(Timestamp time, const Pose& map_from_body, const Rig& rig,
                                    const MapView& map) const;
  // Test of the place at which a frame is found. known: test of that place by earlier frames; nullptr: none.
  PlaceHypothesis hypothesis_of_relocalisation(Timestamp time, const Pose& map_from_body, const PlaceHypothesis* known,
                                               const Rig& rig, const MapView& map) const;

  // Begins a frame. motion: of the body since the last frame; empty: unknown.
  void add_odometry(const std::optional<BodyMotion>& motion);
  // Tilt of the body at this frame, measured by accelerations; empty: unknown.
  void set_tilt(const std::optional<BodyTilt>& tilt) { tilt_ = tilt; }
  int tilts_applied() const { return tilts_applied_; }  // number of bridged poses that a measured tilt constrained
  void note_quality(const PoseQuality& quality) { quality_ = quality; }  // quality of a visual pose

  struct TrackedPose {
    const Frame& frame;
    const HybridTrack& track;
    bool is_relocalised = false;
    bool is_registered = false;
    std::size_t submap = 0;
    bool is_by_hint = false;                       // the search that found it was limited to a hint
    const PlaceView* view = nullptr;               // part of the offline map in view; nullptr without a map
    const PlaceHypothesis* known_place = nullptr;  // for finds: see hypothesis_of_relocalisation; nullptr: none
    double log_odds_of_rivals = kNoRivals;         // see PlaceHypothesis::observe
    double drift_sigma = 0.0;                      // metres, see drift_sigma()
    bool is_jump = false;                          // see is_jump(); counts as a find
  };
  struct Progress {
    double step = 0.0;                // metres of smooth motion
    bool was_accepted = false;        // the pose before was at an accepted place
    bool was_ever_confirmed = false;  // an earlier pose was confirmed, in the reports' frame
  };
  Progress note(const TrackedPose& seen, const Rig& rig, const MapView& map);
  // A submap of the online map begins with these keyframes; the last one is the present frame.
  void begin(const std::vector<KeyframeId>& keyframes, std::size_t submap, const Rig& rig, const MapGraph& online);
  void anchor_to(KeyframeId keyframe) { trajectory_.anchor_last_to(keyframe); }
  void move_to_submap(std::size_t submap, Timestamp after) { trajectory_.move_to_submap(submap, after); }
  void mark_lost();
  // Same as mark_lost(), after the confirmed pose was refuted: no dead reckoning from it.
  void reset();
  // Dead reckoning: propagates a lost pose by measured motion; false without it. ground: constrains the body unless
  // null.
  bool propagate(Timestamp time, const Rig& rig, const MapView& map, const DrivenGround* ground = nullptr);
  // A map correction placed the present submap: the covariance of the bridge to it no longer applies.
  void forget_carried() { carried_.reset(); }
  // Offline points constrain the present pose, with this error of the online map's place (metres, one sigma): the drift
  // begins here if it was larger.
  void note_held(double sigma, double length_sigma);

  void apply_length_changes(const LengthChanges& changes);
  void rotate_rig(const RigRotation& turn, const MapGraph& online);
  void rotate_camera(const Pose& after_from_before);
  void note_online_correction() { odometry_.set_offset({}); }
  // The submap was registered in the offline map, moved by offline_from_online. Starts the test of its place.
  void note_registration(const Pose& offline_from_online, bool is_by_hint);
  // A search of the whole map confirmed the pose found by the hint.
  void note_agreement() { is_by_hint_ = false; }
  // Follows changes of the map. Returns the motion of the last pose, after_from_before; empty without a pose.
  std::optional<Pose> apply_map_correction(const Rig& rig, const MapView& map);

  // Once for each frame: refines and thins out old poses.
  void refine_overdue(const MapView& map, const TrackOptions& tracking);
  void refine_all_deferred(const MapView& map, const TrackOptions& tracking, const AdjustedOffline& offline) {
    trajectory_.refine_all_deferred(map, tracking, offline);
  }

 private:
  struct UncertainPose {
    Pose map_from_body;
    Matrix6 covariance;
  };
  // Pose by measured motion since the last confirmed pose, with the covariance since the last visual pose; empty:
  // unknown motion.
  std::optional<UncertainPose> measured_pose(const Rig& rig, const MapView& map) const;
  double log_odds_of_odometry(const Pose& body, const Rig& rig, const MapView& map) const;
  StampedPose last_known(const Rig& rig, const MapView& map) const;  // precondition: there is a last accepted pose
  void propagate_before_map();
  double move_to(const TrackedPose& seen, const Pose& body, const Rig& rig, const MapView& map);
  void note_disagreement(const HybridTrack& track);
  void note_jump(const TrackedPose& seen, const Pose& body, const Rig& rig, const MapView& map);
  bool is_continued(Timestamp time, const Pose& now, const Rig& rig, const MapView& map) const;
  void add_odometry_covariance(const std::optional<BodyMotion>& odometry_motion);
  bool is_beyond(const Matrix6& covariance, const Pose& predicted_from_body) const;
  bool is_accurate(const BodyMotion& measured) const;
  bool is_odometry_accurate() const;  // is_accurate() for the measured motion since the last visual pose
  void confirm_poses();
  Pose constrained_by(const DrivenGround& ground, const Rig& rig, const Pose& camera_from_map);
  Pose constrained_by(const BodyTilt& tilt, const Rig& rig, const Pose& camera_from_map);
  void record_bridge_end(const Rig& rig, const MapView& map);

  // Constant after construction.
  RegistrationOptions registration_;
  bool on_offline_map_;
  ReachQuery reach_;  // empty: no measured motion

  AnchoredTrajectory trajectory_;
  MotionModel motion_;
  std::optional<BodyMotion> last_odometry_;                  // motion since the frame before
  std::optional<BodyMotion> since_confirmed_ = no_motion();  // motion since the last confirmed pose
  std::optional<BodyMotion> bridge_;
  std::optional<Matrix6> bridge_covariance_;  // covariance in the map after the ground or a tilt constrained the bridge
  std::size_t bridge_begin_ = 0;              // index of the last pose before the bridge
  std::optional<BodyTilt> tilt_;              // at this frame
  std::optional<int> stop_;                   // last stop at which a tilt changed the bridge
  int tilts_applied_ = 0;
  // Poses by measured motion, until the pose found after them is confirmed.
  struct BridgeEnd {
    std::size_t first = 0;   // index of the last pose before the bridge
    std::size_t second = 0;  // index of the found pose
    Pose measured;           // measured first_from_second of the camera
  };
  std::optional<BridgeEnd> bridge_end_;
  PoseQuality quality_;
  std::optional<Timestamp> last_seen_;
  std::optional<UncertainPose> carried_;            // beginning of a submap after a bridge
  std::optional<UncertainPose> bridged_beginning_;  // such a beginning in a mission, until it is registered
  // Covariance due to bridges, at the odometry pose at the end of the last one.
  std::optional<UncertainPose> odometry_open_;
  Odometry odometry_;
  struct Held {
    Pose map_from_body;
    double sigma = 0.0;      // metres
    double travelled = 0.0;  // metres
  };
  std::optional<Held> held_;             // beginning of the drift
  double jump_variance_ = 0.0;           // square metres, see jump_covariance()
  double disagreement_variance_ = 0.0;   // square metres, of an open disagreement of the maps
  double contradiction_variance_ = 0.0;  // square metres, of an offline pose against a precise online map, this frame
  PlaceHypothesis place_;
  PlaceHypothesis place_before_;  // last confirmed and accepted place before its pose was lost
  bool is_by_hint_ = false;
  std::optional<Timestamp> last_confirmed_;   // in the reports' frame
  std::optional<StampedPose> last_accepted_;  // the last pose at an accepted place, in the reports' frame
  bool has_pose_ = false;
  bool is_path_measured_ = true;  // motion since the last confirmed pose is known
  double scene_depth_ = 1.0;      // metres, median depth of the points in the last frame
};

}  // namespace byre
