#pragma once

#include "byre/base/scratch_memory.h"
#include "byre/map/map_view.h"
#include "byre/optimise/pose_refinement.h"
#include "byre/slam/tracking/image_mask.h"

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
  // Covariance of delta in exp_pose(delta) * camera_from_world relative to the map's origin: that of the matches plus
  // that of the reference keyframe.
  Matrix6 covariance = Matrix6::Zero();
  Matrix6 match_covariance = Matrix6::Zero();  // covariance of the matches, relative to the map around the camera
  KeyframeId reference;                        // the keyframe that shares most points
  ScratchVector<TrackedFeature> features;      // inliers only, ascending
  ScratchVector<TrackedFeature> outliers;      // matches that contradict the pose
  int expected = 0;                            // map points in the frustum
  int matches = 0;                             // expected points matched, before outlier removal
};

// Outliers that match their point's own patch, as features, ascending: their points have moved, or are moving.
std::vector<int> contradicting_features(const TrackedFrame& tracked, const Features& features);

// A map point matched in a frame.
struct SeenPoint {
  PointId point;
  Eigen::Vector2f pixel;  // in the left rectified image
  bool is_inlier = false;
};

// Appends inliers, then outliers, for display.
void append_seen_points(const TrackedFrame& tracked, std::vector<SeenPoint>& seen);

struct TrackOptions {
  float search_radius = 12.0f;  // pixels at octave 0, around the predicted pixel
  float wide_radius = 40.0f;    // pixels at octave 0, if the first search finds too little
  int min_inliers = 25;
  double offline_weight = 2.0;  // weight of a measured offline point; an online one has 1
  ImageMask hidden{};           // image cells without expected points
};

// Points seen by a keyframe and by its most covisible keyframes; ascending, bounded for any size of the map.
ScratchVector<PointId> local_points(const MapView& map, KeyframeId reference, int max_keyframes);

// Projects the candidates from the predicted pose, matches them nearby, refines the pose, matches the rest around it,
// refines all matches in the image, and refines the pose on those. A first search with too few matches or too many
// outliers is repeated in wide_radius. Empty if too few inliers remain or most matches disagree.
std::optional<TrackedFrame> track(const Frame& frame, const Pose& predicted_camera_from_world, const Rig& rig,
                                  const MapView& map, std::span<const PointId> candidates, const TrackOptions& options);

// Fallback for a wrong prediction: matches descriptors with one keyframe's points anywhere in the image, and estimates
// the pose by RANSAC with three points. The result is a prediction for track().
std::optional<Pose> pose_from_keyframe(const Frame& frame, const Rig& rig, const MapView& map, KeyframeId keyframe);

}  // namespace byre
