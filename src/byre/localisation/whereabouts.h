#pragma once

#include "byre/features/rolling_shutter.h"
#include "byre/health.h"
#include "byre/localisation/odometry.h"
#include "byre/map/driven_ground.h"
#include "byre/mapping/anchored_trajectory.h"
#include "byre/slam/hybrid_tracking.h"
#include "byre/slam/motion_model.h"
#include "byre/slam/place_hypothesis.h"
#include "byre/slam/registration.h"
#include "byre/slam/told_motions.h"

#include <optional>
#include <utility>
#include <vector>

namespace byre {

// The keyframe that a tracked frame's pose is kept relative to.
KeyframeId anchor_of(const HybridTrack& track);

// What is known of where the robot is, and was: what a frame adds to that, and what changes of the map do to it. Reads
// maps, and changes nothing but itself. Called from the session's thread.
class Whereabouts {
 public:
  // What was reported of a pose.
  struct PoseQuality {
    Matrix6 covariance = Matrix6::Zero();           // see FrameReport
    Matrix6 odometry_covariance = Matrix6::Zero();  // see FrameReport
    Verdict verdict = Verdict::untrusted;
  };

  // on_offline_map: finds are to be confirmed, and sightings kept.
  Whereabouts(const RegistrationOptions& registration, const HindsightOptions& hindsight,
              const TrajectoryOptions& trajectory, bool on_offline_map)
      : registration_(registration), on_offline_map_(on_offline_map), trajectory_(hindsight, trajectory) {}

  // Before the first frame.
  void hear(TellReach reach) { reach_ = std::move(reach); }

  bool has_pose() const { return has_pose_; }  // in the last frame
  // Test of the pose's place in the offline map.
  const PlaceHypothesis& place() const { return place_; }
  // The pose was found by a search near a hint only, and is not accepted yet.
  bool is_by_hint() const { return is_by_hint_; }
  const AnchoredTrajectory& trajectory() const { return trajectory_; }
  const MotionModel& motion() const { return motion_; }
  const Odometry& odometry() const { return odometry_; }
  CameraMotion camera_motion() const { return {motion_.velocity(), scene_depth_}; }
  // Time of the last believed pose in the reports' frame.
  std::optional<Timestamp> last_believed() const { return last_believed_; }
  // The pose was lost, and it is known how the body has moved since, so well that points are found by it.
  bool may_be_led_back() const { return !has_pose_ && is_way_known_ && is_led_well(); }
  // The way from the last pose that was seen to where the body is by what is told; empty unless the last frame showed
  // nothing. Before there is a map it is the way from the first frame that was told of, where the map's frame will be.
  std::optional<BodyMotion> bridge() const { return has_pose_ ? std::nullopt : bridge_; }
  // Before there is a map: the body in the frame that a map which begins with this frame is to have.
  std::optional<Pose> told_beginning() const;
  const PoseQuality& quality_before() const { return quality_; }  // what was reported of the last pose that was seen
  Matrix6 covariance_of_bridge() const;  // covariance of the pose in the map, now; precondition: there is a bridge
  Matrix6 carried_covariance() const;  // covariance of the pose in the map, beside what the present submap leaves open
  // Covariance of the odometry by bridges that ended at found places; without the drift of visual odometry.
  Matrix6 bridged_odometry_covariance() const;
  std::optional<Timestamp> last_seen() const { return last_seen_; }  // time of the last pose that was seen
  // Whether measured motion since the last pose that was seen contradicts the pose of a track: then it is another place
  // that looks alike. False for a pose that continues the camera's motion, and while the last pose was untrusted.
  // Without an offline map false after half a minute, when the robot may have been carried.
  bool is_out_of_reach(const Frame& frame, const HybridTrack& track, const Rig& rig, const MapView& map) const;
  // Prior log-odds that the present submap, not registered yet, lies so in the offline map, by the measured motion up
  // to its beginning. 0 where that is not known.
  double log_odds_of_registration(const Pose& offline_from_online) const;

  // Prior log-odds of a place where the body is found without a prediction, by the way from the last accepted pose.
  double log_odds_of_find(Timestamp time, const Pose& map_from_body, const Rig& rig, const MapView& map) const;
  // Test of the place at which a frame is found. known: test of that place by earlier frames; nullptr: none.
  PlaceHypothesis hypothesis_of_find(Timestamp time, const Pose& map_from_body, const PlaceHypothesis* known,
                                     const Rig& rig, const MapView& map) const;

  // A frame later; motion is that of the body, where it is known.
  void tell(const std::optional<BodyMotion>& motion);
  // How the body is tilted at this frame, where accelerations tell it.
  void tell_tilt(const std::optional<BodyTilt>& tilt) { tilt_ = tilt; }
  int tilts_held() const { return tilts_held_; }  // poses of bridges, held by what accelerations told
  // What the last frame's report says, of a pose that was seen.
  void note_quality(const PoseQuality& quality) { quality_ = quality; }

  struct TrackedPose {
    const Frame& frame;
    const HybridTrack& track;
    bool from_nothing = false;
    bool is_registered = false;
    std::size_t submap = 0;
    bool is_by_hint = false;          // where it was found from nothing: it was looked for near a hint alone
    const PlaceView* view = nullptr;  // the part of the offline map that it shows; nullptr without a map
    const PlaceHypothesis* known_place = nullptr;  // where it was found from nothing: see hypothesis_of_find
    double log_odds_of_rivals = kNoRivals;         // see PlaceHypothesis::observe
  };
  // What a tracked frame changed.
  struct Progress {
    double step = 0.0;               // metres, smooth
    bool was_proven = false;         // the pose before, beyond doubt
    bool was_ever_believed = false;  // a pose in the reports' frame before
  };
  Progress note(const TrackedPose& seen, const Rig& rig, const MapView& map);
  // A submap of the online map begins with the last of these keyframes, made of this frame.
  void begin(const std::vector<KeyframeId>& keyframes, std::size_t submap, const Rig& rig, const Map& online);
  // The last frame has become a keyframe.
  void anchor_to(KeyframeId keyframe) { trajectory_.anchor_last_to(keyframe); }
  void lose();
  // As lose(), and where the robot was believed to be was wrong: it is not led on from there.
  void give_up();
  // Nothing was seen, and the pose goes on by what is told, where it is: whether it does. ground: that the body is held
  // to; nullptr for none.
  bool go_on(Timestamp time, const Rig& rig, const MapView& map, const DrivenGround* ground = nullptr);
  // Places told of the present submap anew: nothing is left of what a bridge to it left open.
  void forget_carried() { carried_.reset(); }

  // Changes of the map, or of the camera.
  void follow(const LengthChanges& changes);
  void turn(const RigTurn& turn, const Map& online);
  void turn_camera(const Pose& after_from_before);
  void note_online_correction() { odometry_.remember_offset({}); }
  // The submap was registered in the offline map, and moved by offline_from_online. Starts the test of its place.
  void note_registration(const Pose& offline_from_online, bool is_by_hint);
  // A search of the whole map agrees with the pose found by the hint.
  void note_agreement() { is_by_hint_ = false; }
  // By what the map moved the last pose, after_from_before; empty where there is none.
  std::optional<Pose> follow_map(const Rig& rig, const MapView& map);

  // Once for each frame: what was long ago is settled, and thinned out.
  void settle_overdue(const MapView& map, const TrackOptions& tracking);
  void settle_all(const MapView& map, const TrackOptions& tracking) { trajectory_.settle_all(map, tracking); }

 private:
  // Pose by measured motion since the last believed pose, and its covariance since the last pose that was seen.
  struct MeasuredPose {
    Pose map_from_body;
    Matrix6 covariance;
  };
  std::optional<MeasuredPose> measured_pose(const Rig& rig, const MapView& map) const;  // empty: unknown motion
  struct Accepted {
    Timestamp time{};
    Pose map_from_body;
  };
  double log_odds_of_way(const Pose& body, const Rig& rig, const MapView& map) const;
  Accepted last_known(const Rig& rig, const MapView& map) const;  // precondition: there is a last accepted pose
  void wait_for_map();
  double move_to(const TrackedPose& seen, const Pose& body, const Rig& rig, const MapView& map);
  bool is_continued(Timestamp time, const Pose& now, const Rig& rig, const MapView& map) const;
  void open_odometry(const std::optional<BodyMotion>& led);
  bool is_beyond(const Matrix6& covariance, const Pose& led_from_body) const;
  bool leads_well(const BodyMotion& told) const;
  bool is_led_well() const;  // by what was told since the last pose that was believed
  void believe();
  Pose held_to(const DrivenGround& ground, const Rig& rig, const Pose& camera_from_map);
  Pose held_to(const BodyTilt& tilt, const Rig& rig, const Pose& camera_from_map);
  void note_end_of_bridge(const Rig& rig, const MapView& map);

  // Constant after construction.
  RegistrationOptions registration_;
  bool on_offline_map_;
  TellReach reach_;  // empty: nothing is told

  AnchoredTrajectory trajectory_;
  MotionModel motion_;
  std::optional<BodyMotion> last_told_;                     // since the frame before
  std::optional<BodyMotion> since_believed_ = no_motion();  // since the last pose that is believed
  std::optional<BodyMotion> bridge_;
  std::optional<Matrix6> bridge_covariance_;  // covariance in the map, where the ground adds to what is told
  std::size_t bridge_begin_ = 0;              // index of the last pose before the bridge
  std::optional<BodyTilt> tilt_;              // at this frame
  std::optional<int> stop_;                   // the last stop at which the bridge was tilted
  int tilts_held_ = 0;
  // Poses led on by what was told, until the pose that was found after them is believed.
  struct BridgeEnd {
    std::size_t first = 0;   // index of the last pose before
    std::size_t second = 0;  // index of the pose that was found
    Pose told;               // first_from_second of the camera
  };
  std::optional<BridgeEnd> bridge_end_;
  PoseQuality quality_;
  std::optional<Timestamp> last_seen_;
  // Where the present submap was begun by a bridge, and how uncertain that was.
  struct Carried {
    Pose map_from_body;
    Matrix6 covariance;
  };
  std::optional<Carried> carried_;
  std::optional<Carried> bridged_beginning_;  // where a mission's submap began after a bridge, until it is registered
  std::optional<Carried> odometry_open_;      // covariance by bridges, at the odometry pose where the last one ended
  Odometry odometry_;
  PlaceHypothesis place_;
  PlaceHypothesis place_before_;  // the last one that was believed and accepted, before its pose was lost
  bool is_by_hint_ = false;
  std::optional<Timestamp> last_believed_;  // in the reports' frame
  std::optional<Accepted> last_accepted_;   // the last pose at an accepted place, in the reports' frame
  bool has_pose_ = false;
  bool is_way_known_ = true;  // from the last pose that was believed
  double scene_depth_ = 1.0;  // metres, median of the points in the last frame
};

}  // namespace byre
