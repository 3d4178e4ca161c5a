#pragma once

#include "byre/slam/health.h"
#include "byre/slam/hybrid_tracking.h"
#include "byre/slam/offline_map.h"
#include "byre/slam/registration.h"
#include "byre/slam/state.h"
#include "byre/slam/suspension.h"

#include <memory>
#include <optional>
#include <vector>

namespace byre {

struct MissionOptions {
  int local_keyframes = 15;       // offline ones, whose points are looked for in a frame
  double search_distance = 4.0;   // metres about the pose within which offline keyframes are looked for
  double min_drift = 0.01;        // metres by which a place found beside tracking may always lie off the pose,
  double drift_share = 0.02;      // and of the path since offline points last held it
  double min_turn = 0.005;        // radians that it may be turned,
  double turn_per_metre = 0.002;  // and for each metre of that path
  int look_again_every = 5;       // frames: then suspended points are looked for in their places
  int held_by = 60;               // offline inliers from which the online map around is taken to lie in its place
  double search_after = 0.3;      // metres without offline points: then places are looked for beside tracking
  double restart_after = 1.0;     // seconds without a pose, until a new piece of online map is begun
  OfflineViewOptions view;
  SuspensionOptions suspension;
  RegistrationOptions registration;
};

// What a session knows of its way in the offline map: which of its points to look for, how long ago they last held the
// pose, and how the online map lies in it. Called from the session's thread.
class Mission {
 public:
  Mission(std::shared_ptr<const OfflineMap> offline, const MissionOptions& options)
      : offline_(std::move(offline)), options_(options), suspension_(options.suspension) {}

  const OfflineMap& offline() const { return *offline_; }
  const Suspension& suspension() const { return suspension_; }
  OfflineView view() const { return view_; }
  double distance_since_offline() const { return distance_since_offline_; }
  std::optional<Timestamp> last_offline_time() const { return last_offline_time_; }
  DriftBound drift() const;

  // Offline points to look for from a predicted pose: those around the keyframe that showed most of them in the last
  // frame, or around the one nearest to the pose.
  const std::vector<PointId>& candidates(const Pose& predicted_camera_from_world);

  // A frame was tracked, so many metres from the one before.
  void note(const HybridTrack& track, Timestamp time, double step, const OfflineEvidence& evidence);
  // Suspended points around, in frames where they are to be looked for again; else none.
  std::vector<PointId> due_again() const;
  void note_again(const PlacedPoints& placed) { suspension_.note_again(placed.agreed, placed.moved); }
  // Offline points are not known to hold the pose any more, or not yet.
  void forget_reference() { reference_.reset(); }

  // What a frame says of where the online map lies in the offline one: a correction, once enough frames agree.
  std::optional<Pose> consider(const Pose& offline_from_online, const Eigen::Vector3d& camera_in_online,
                               double median_depth);
  void forget_hypothesis() { hypothesis_.reset(); }

 private:
  // Constant after construction.
  std::shared_ptr<const OfflineMap> offline_;
  MissionOptions options_;

  Suspension suspension_;
  OfflineView view_ = OfflineView::off_the_map;
  double distance_since_offline_ = 0.0;  // metres
  std::optional<Timestamp> last_offline_time_;
  int frames_ = 0;                               // noted
  std::optional<KeyframeId> reference_;          // offline keyframe that showed most of the last frame's points
  std::optional<KeyframeId> candidates_around_;  // of which the points below are
  std::vector<PointId> local_points_;            // suspended ones included
  std::vector<PointId> candidates_;
  std::optional<RegistrationHypothesis> hypothesis_;
};

}  // namespace byre
