#pragma once

#include "byre/localisation/place_bounds.h"
#include "byre/slam/health.h"
#include "byre/slam/hybrid_tracking.h"
#include "byre/slam/moved_points.h"
#include "byre/slam/offline_map.h"
#include "byre/slam/place_hypothesis.h"
#include "byre/slam/registration.h"
#include "byre/slam/state.h"

#include <memory>
#include <optional>
#include <vector>

namespace byre {

inline constexpr int kOfflineThatHolds = 60;  // offline inliers with which the online map around lies in its place

struct MissionOptions {
  double search_after = 0.3;   // metres without offline points, from which places are looked for beside tracking
  double restart_after = 1.0;  // seconds without a pose, from which a new piece of online map is begun
  OfflineViewOptions view;
  MovedPointsOptions moved_points;
  RegistrationOptions registration;
  PlaceBoundsOptions bounds;
};

// What a session knows of its way in the offline map: which of its points to look for, how long ago they last held the
// pose, and how the online map lies in it. Called from the session's thread.
class Mission {
 public:
  Mission(std::shared_ptr<const OfflineMap> offline, const MissionOptions& options)
      : offline_(std::move(offline)), options_(options), moved_points_(options.moved_points) {}

  const OfflineMap& offline() const { return *offline_; }
  const MovedPoints& moved_points() const { return moved_points_; }
  OfflineView view() const { return view_; }
  double distance_since_offline() const { return distance_since_offline_; }
  std::optional<Timestamp> last_offline_time() const { return last_offline_time_; }
  DriftBound drift() const;
  // How far offline points may put a camera that was last tracked so many seconds ago, at a place that was proven.
  HybridLimits limits(bool is_stereo, double seconds) const;

  // Where offline points are to be looked for from a predicted pose: around the keyframe that showed most of them in
  // the last frame, or around the one nearest to the pose.
  std::optional<KeyframeId> keyframe_near(const Pose& predicted_camera_from_world) const;
  // The points around it that are looked for.
  void append_candidates(std::span<const PointId> around, ReusedVector<PointId>& candidates) const;

  // A frame was tracked, so many metres from the one before.
  void note(const HybridTrack& track, Timestamp time, double step, const OfflineEvidence& evidence);
  // Suspended points around, in frames where they are to be looked for again; else none.
  ReusedVector<PointId> due_again(std::span<const PointId> around) const;
  void note_again(const PlacedPoints& placed) { moved_points_.note_again(placed.agreed, placed.moved); }
  // Offline points are not known to hold the pose any more, or not yet.
  void forget_reference() { reference_.reset(); }

  // A frame found or tracked in both maps, see test_registration().
  struct RegistrationEvidence {
    Pose offline_from_online;
    Eigen::Vector3d camera_in_online;  // metres
    double median_depth = 0.0;         // metres
    const PlaceView& view;             // the part of the offline map that it shows
  };
  // Tests where the online map lies in the offline one. begun: the test to begin with. Returns the pose once enough
  // frames agree, and what should be seen does not contradict them.
  std::optional<Pose> test_registration(const RegistrationEvidence& seen, const PlaceHypothesis& begun);
  void forget_registration() { registration_.reset(); }

 private:
  // Constant after construction.
  std::shared_ptr<const OfflineMap> offline_;
  MissionOptions options_;

  MovedPoints moved_points_;
  OfflineView view_ = OfflineView::off_the_map;
  double distance_since_offline_ = 0.0;  // metres
  std::optional<Timestamp> last_offline_time_;
  int frames_ = 0;                       // noted
  std::optional<KeyframeId> reference_;  // offline keyframe that showed most of the last frame's points
  struct Registration {
    Pose offline_from_online;
    PlaceHypothesis place;
    int misses = 0;  // frames that contradict it
  };
  std::optional<Registration> registration_;
};

}  // namespace byre
