#pragma once

#include "byre/slam/health.h"
#include "byre/slam/tracking.h"

#include <optional>
#include <vector>

namespace byre {

// By how much the online map may lie off the offline one, for all that is known.
struct DriftBound {
  double translation = 0.05;  // metres
  double rotation = 0.02;     // radians
};

// How far apart two poses camera_from_world put the camera.
Agreement agreement_of(const Pose& one, const Pose& other);

bool is_within(const Agreement& agreement, const DriftBound& drift);

// A frame tracked on the points of an offline and an online map.
struct HybridTrack {
  TrackedFrame tracked;
  std::optional<KeyframeId> offline_reference;  // of each map, the keyframe that shares most points
  std::optional<KeyframeId> online_reference;
  int offline_expected = 0;
  int offline_matches = 0;
  int offline_inliers = 0;
  std::optional<Pose> from_offline;  // camera_from_world, as offline points alone have it
  std::optional<Pose> from_online;   // as online points alone have it
  bool maps_disagree = false;        // those two are farther apart than noise explains,
  // By no more than drift explains, and the offline pose is certain enough to tell: then the pose is that one.
  bool offline_is_right = false;
  std::vector<PointId> offline_agreed;  // inliers, and
  std::vector<PointId> offline_moved;   // offline points found in the image elsewhere than the pose has them

  int online_inliers() const { return static_cast<int>(tracked.features.size()) - offline_inliers; }
};

// As track(), for candidates of both maps. Each kind of points gives a pose of its own; where those agree, the pose is
// refined on both, offline measurements weighing more. Where they do not, one map is wrong hereabouts: the online one
// when no more than drift needs to be assumed, else things have moved since the offline map was made.
std::optional<HybridTrack> track_hybrid(const Frame& frame, const Pose& predicted_camera_from_world, const Rig& rig,
                                        const MapView& map, const std::vector<PointId>& candidates,
                                        const DriftBound& drift, const TrackOptions& options);

}  // namespace byre
