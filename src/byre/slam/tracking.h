#pragma once

#include "byre/map/map_view.h"
#include "byre/optimise/pose_refinement.h"
#include "byre/slam/hidden_cells.h"
#include "byre/workers/reused_memory.h"

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace byre {

struct TrackedFeature {
  int feature = 0;
  PointId point;
  Eigen::Vector2f pixel;  // refined, full-resolution pixels
  float pixel_sigma = 1.0f;
};

struct TrackedFrame {
  Pose camera_from_world;
  // Covariance of delta in exp_pose(delta) * camera_from_world, relative to the map's origin: what the matches leave
  // open, and what the reference keyframe's own pose does.
  Matrix6 covariance = Matrix6::Zero();
  Matrix6 match_covariance = Matrix6::Zero();  // what the matches leave open, relative to the map around the camera
  KeyframeId reference;                        // the keyframe that shares most points
  ReusedVector<TrackedFeature> features;       // inliers only, ascending
  ReusedVector<TrackedFeature> outliers;       // matches that are not where the pose has their points
  int expected = 0;                            // map points in the frustum
  int matches = 0;                             // expected points matched, before outliers were taken out
};

// Outliers where the point's very patch was found, as features, ascending: what they show has moved, or moves.
std::vector<int> contradicting_features(const TrackedFrame& tracked, const Features& features);

// A map point as it was matched in a frame.
struct SeenPoint {
  PointId point;
  Eigen::Vector2f pixel;  // in the left rectified image
  bool is_inlier = false;
};

// What there is to show of a tracked frame: inliers, then outliers.
void append_seen_points(const TrackedFrame& tracked, std::vector<SeenPoint>& seen);

// In which order points of an offline map and of an online one are used.
//   first     a pose from offline points, where there are enough, guides the search for online ones
//   together  both are looked for around the prediction
enum class OfflinePolicy : std::uint8_t { first, together };

struct TrackOptions {
  float search_radius = 12.0f;  // pixels at octave 0, about the predicted pixel
  float wide_radius = 40.0f;    // pixels at octave 0, when the first search finds too little
  int min_inliers = 25;
  OfflinePolicy offline_policy = OfflinePolicy::first;
  double offline_weight = 2.0;  // weight of a measured offline point, against 1 of an online one
  HiddenCells hidden{};         // where no points are asked for
};

// Points seen by a keyframe and by those most covisible with it; ascending, bounded whatever the map's size.
ReusedVector<PointId> local_points(const MapView& map, KeyframeId reference, int max_keyframes);

// Projects the candidates from the predicted pose, matches them nearby, refines the pose, matches the rest around it,
// refines all matches in the image, and the pose again on those. A first search that finds too little, or too much that
// does not agree, is repeated in wide_radius. Empty when too few inliers remain or most matches disagree.
std::optional<TrackedFrame> track(const Frame& frame, const Pose& predicted_camera_from_world, const Rig& rig,
                                  const MapView& map, std::span<const PointId> candidates, const TrackOptions& options);

// Where prediction has failed: matches descriptors with one keyframe's points wherever they are in the image, and
// finds the pose from three points at a time. The result is a prediction for track().
std::optional<Pose> pose_from_keyframe(const Frame& frame, const Rig& rig, const MapView& map, KeyframeId keyframe);

}  // namespace byre
