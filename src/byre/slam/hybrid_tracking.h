#pragma once

#include "byre/slam/focal_check.h"
#include "byre/slam/health.h"
#include "byre/slam/tracking.h"

#include <limits>
#include <optional>
#include <span>
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
  std::optional<KeyframeId> offline_reference;  // offline keyframe that shares most points
  std::optional<KeyframeId> online_reference;
  int offline_expected = 0;
  int offline_matches = 0;
  int offline_inliers = 0;
  std::optional<Pose> from_offline;                  // camera_from_world, as offline points alone have it
  std::optional<Pose> from_online;                   // camera_from_world, as online points alone have it
  Matrix6 from_online_covariance = Matrix6::Zero();  // covariance of delta in exp_pose(delta) * from_online
  bool maps_disagree = false;                        // both poses are farther apart than their covariances explain
  // One rigid pose puts most offline points, all over the image, where their patches are found: it stands.
  bool offline_stands = false;
  std::optional<FocalEvidence> focal;    // what offline points say of the focal length, where they were asked
  ReusedVector<PointId> offline_agreed;  // offline points that fit the pose
  ReusedVector<PointId> offline_moved;   // offline points found in the image elsewhere than the pose has them

  // The online map does not lie where it should.
  bool is_online_off() const { return maps_disagree && offline_stands; }
  int online_inliers() const { return static_cast<int>(tracked.features.size()) - offline_inliers; }
};

// How far offline points may put the camera from where it is known to be, where they come first: farther off is a place
// that looks the same.
struct HybridLimits {
  DriftBound drift{kNoLimit, kNoLimit};  // from where online points have it
  double stray = kNoLimit;               // metres from the prediction, where online points do not have it
  std::optional<PosePrior> prior{};      // what is known of the pose besides; of use to points of both kinds
  static constexpr double kNoLimit = std::numeric_limits<double>::infinity();
};

// As track(), for candidates of both maps. Each kind of points gives a pose of its own. Offline comes first: where one
// pose fits offline points all over the image it stands, within the limits whatever the online map says, and online
// points are used that agree with it. Offline points that fit one pose in a part of the image only may be a thing that
// was moved: where the maps disagree the online pose stands, and offline points are used that agree with that.
// weighs_focal_lengths: offline points are asked what they make of other ones, see FocalCheck.
std::optional<HybridTrack> track_hybrid(const Frame& frame, const Pose& predicted_camera_from_world, const Rig& rig,
                                        const MapView& map, std::span<const PointId> candidates,
                                        const TrackOptions& options, const HybridLimits& limits = {},
                                        bool weighs_focal_lengths = false);

// Which points a pose that is known has in their places, and which elsewhere.
struct PlacedPoints {
  ReusedVector<PointId> agreed;
  ReusedVector<PointId> moved;
};

// Looks for points where the pose expects them, without a say in it. Those not found are in neither.
PlacedPoints look_for_points(const Frame& frame, const Pose& camera_from_world, const Rig& rig, const MapView& map,
                             std::span<const PointId> points, const TrackOptions& options);

}  // namespace byre
