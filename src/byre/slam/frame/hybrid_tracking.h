#pragma once

#include "byre/slam/frame/focal_check.h"
#include "byre/slam/frame/health.h"
#include "byre/slam/tracking/tracking.h"

#include <limits>
#include <optional>
#include <span>

namespace byre {

// Difference of two poses camera_from_world.
Agreement agreement_of(const Pose& one, const Pose& other);

bool is_within(const Agreement& agreement, const Agreement& bound);

// A frame tracked on the points of an offline and an online map.
struct HybridTrack {
  TrackedFrame tracked;
  std::optional<KeyframeId> offline_reference;  // offline keyframe that shares most points
  std::optional<KeyframeId> online_reference;
  int offline_expected = 0;
  int offline_matches = 0;
  int offline_inliers = 0;
  std::optional<Pose> from_offline;                  // camera_from_world by offline points alone
  std::optional<Pose> from_online;                   // camera_from_world by online points alone
  Matrix6 from_online_covariance = Matrix6::Zero();  // covariance of delta in exp_pose(delta) * from_online
  bool maps_disagree = false;                        // the poses differ by more than their covariances explain
  // One rigid pose fits most offline points by their patches, all over the image: it takes precedence.
  bool offline_prevails = false;
  double offline_sigma = 0.0;             // metres, position of from_offline
  bool depends_on_online = false;         // an error of the online map's place is one of the pose
  double online_sigma = 0.0;              // see HybridLimits
  std::optional<FocalEvidence> focal;     // evidence of offline points on the focal length, if weighed
  ScratchVector<PointId> offline_agreed;  // offline points that fit the pose
  ScratchVector<PointId> offline_moved;   // offline points found away from their predictions

  // The online map is displaced.
  bool is_online_displaced() const { return maps_disagree && offline_prevails; }
  int online_inliers() const { return static_cast<int>(tracked.features.size()) - offline_inliers; }
};

// Error of the online map's place in the offline one, by the frame's poses on each: metres, one sigma.
double sigma_between_maps(const HybridTrack& track);

// Limits of a pose from offline points. A pose beyond them is that of a look-alike place.
struct HybridLimits {
  Agreement drift{kNoLimit, kNoLimit};  // from the pose by online points
  double stray = kNoLimit;              // metres from the prediction, without a pose by online points
  std::optional<PosePrior> prior{};     // prior of the pose, for points of both maps
  double online_sigma = kNoLimit;       // metres, of the online map's place in the offline one; infinite: unknown
  static constexpr double kNoLimit = std::numeric_limits<double>::infinity();
};

// Same as track(), for candidates of both maps. The points of each map give a pose. If one pose fits offline points all
// over the image, it takes precedence over the online map within the limits, and online points that agree with it are
// used: within its covariance if the online map is placed more precisely, else within noise. Offline points that fit
// one pose only in a part of the image may be on a moved object: if the maps disagree, the online pose is used, with
// the offline points that agree with it. compares_focal_lengths: sets `focal`, see FocalCheck.
std::optional<HybridTrack> track_hybrid(const Frame& frame, const Pose& predicted_camera_from_world, const Rig& rig,
                                        const MapView& map, std::span<const PointId> candidates,
                                        const TrackOptions& options, const HybridLimits& limits = {},
                                        bool compares_focal_lengths = false);

// Points found at their predictions from a given pose, and points found elsewhere.
struct SearchedPoints {
  ScratchVector<PointId> agreed;
  ScratchVector<PointId> moved;
};

// Matches points around their predictions without changing the pose. Points not found are in neither list.
SearchedPoints search_points(const Frame& frame, const Pose& camera_from_world, const Rig& rig, const MapView& map,
                             std::span<const PointId> points, const TrackOptions& options);

}  // namespace byre
