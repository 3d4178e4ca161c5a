#pragma once

#include "byre/slam/frame/health.h"
#include "byre/slam/frame/hybrid_tracking.h"
#include "byre/slam/frame/state.h"
#include "byre/slam/localisation/place_bounds.h"
#include "byre/slam/places/offline_map.h"
#include "byre/slam/places/place_hypothesis.h"
#include "byre/slam/window/moved_points.h"
#include "byre/slam/window/registration.h"

#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <vector>

namespace byre {

// Offline inliers from which nearby online keyframes count as aligned with the offline map.
inline constexpr int kOfflineThatHolds = 36;

struct MissionOptions {
  double search_after = 0.3;   // metres without offline points before places are searched in parallel with tracking
  double restart_after = 1.0;  // seconds without a pose before a new online submap begins
  OfflineViewOptions view;
  MovedPointsOptions moved_points;
  RegistrationOptions registration;
  PlaceBoundsOptions bounds;
};

// The session's state on the offline map: which of its points to match, when they last constrained the pose, and the
// registration of the online map. Called from the session's thread.
class Mission {
 public:
  Mission(std::shared_ptr<const OfflineMap> offline, const MissionOptions& options)
      : offline_(std::move(offline)), options_(options), moved_points_(options.moved_points) {}

  const OfflineMap& offline() const { return *offline_; }
  const MovedPoints& moved_points() const { return moved_points_; }
  OfflineView view() const { return view_; }
  double distance_since_offline() const { return distance_since_offline_; }
  std::optional<Timestamp> last_offline_time() const { return last_offline_time_; }
  Agreement drift() const;  // bound on the offset between online and offline map
  // Limits of the pose from offline points at an accepted place. seconds: time since the last tracked frame.
  HybridLimits limits(bool is_stereo, double seconds) const;

  // Offline keyframe whose points are matched from a predicted pose: the one that shared most points with the last
  // frame, otherwise the one nearest to the pose.
  std::optional<KeyframeId> keyframe_near(const Pose& predicted_camera_from_world) const;
  // Appends the points that are not suspended.
  void append_candidates(std::span<const PointId> around, ScratchVector<PointId>& candidates) const;

  // Adds a tracked frame. step: metres from the frame before.
  void note(const HybridTrack& track, Timestamp time, double step, const OfflineEvidence& evidence);
  // Suspended points in frames that search for them again; otherwise empty.
  ScratchVector<PointId> due_for_retest(std::span<const PointId> around) const;
  void note_retest(const SearchedPoints& points) { moved_points_.note_retest(points.agreed, points.moved); }
  // Offline points do not constrain the pose now.
  void forget_reference() { reference_.reset(); }

  // A frame tracked or localised in both maps, see test_registrations().
  struct RegistrationEvidence {
    Pose offline_from_online;
    Eigen::Vector3d camera_in_online;  // metres
    double median_depth = 0.0;         // metres
    const PlaceView& view;             // part of the offline map in view
  };
  // Tests poses of the online map in the offline one. places: those at which a frame was found, which contradict each
  // other. begin: test to begin with. Returns the likeliest pose with which enough frames agree, unless the cells in
  // view contradict it.
  std::optional<Pose> test_registrations(std::span<const RegistrationEvidence> places,
                                         const std::function<PlaceHypothesis(const Pose& offline_from_online)>& begin);
  void forget_registrations() { registrations_.clear(); }

 private:
  // Constant after construction.
  std::shared_ptr<const OfflineMap> offline_;
  MissionOptions options_;

  MovedPoints moved_points_;
  OfflineView view_ = OfflineView::off_the_map;
  double distance_since_offline_ = 0.0;  // metres
  std::optional<Timestamp> last_offline_time_;
  int frames_ = 0;
  std::optional<KeyframeId> reference_;  // offline keyframe that shares most points with the last frame
  struct Registration {
    Pose offline_from_online;
    PlaceHypothesis place;
    int misses = 0;  // frames found elsewhere only
  };
  std::vector<Registration> registrations_;  // poses that contradict each other
};

}  // namespace byre
