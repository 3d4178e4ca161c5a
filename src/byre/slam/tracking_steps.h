#pragma once

#include "byre/slam/guided_matching.h"
#include "byre/slam/measurement.h"
#include "byre/slam/tracking.h"

#include <optional>
#include <span>
#include <utility>
#include <vector>

// The steps that tracking on one map and on two have in common.
namespace byre {

inline constexpr float kNarrowRadius = 4.0f;  // pixels at octave 0, about where a first pose expects a point

PoseObservation pose_observation(const MapPoint& point, const StereoPixel& measured, double pixel_sigma,
                                 double disparity_sigma);

// As project_points(), but for points that are hidden. Refills `expected`.
void project_visible(const MapView& map, std::span<const PointId> points, const Pose& camera_from_world, const Rig& rig,
                     const HiddenCells& hidden, std::vector<ExpectedPoint>& expected);

// Matches measured in the image: what each says of the pose, and what it becomes when it is an inlier; in step.
struct MeasuredPoints {
  std::vector<PoseObservation> observations;
  std::vector<TrackedFeature> features;
};

// Each match by its point's reference patch, where that keyframe still exists, else by its corner. Refills `measured`.
void measure_matches(const Frame& frame, const Pose& camera_from_world, const Rig& rig, const MapView& map,
                     const std::vector<GuidedMatch>& matches, MeasuredPoints& measured);

// Matches as a pose that stands already has them.
struct PartedPoints {
  MeasuredPoints agreeing;
  std::vector<TrackedFeature> disagreeing;
};

// max_variance_factor: by which their errors may exceed their sigmas, as they do for the points that gave the pose.
// Refills `parted`.
void part_by_agreement(const Pose& camera_from_world, const Rig& rig, const MeasuredPoints& measured,
                       double max_variance_factor, PartedPoints& parted);

// Whether enough of the matches agree on the pose.
bool is_sound(const PoseRefinement& refined, std::size_t matches, const TrackOptions& options);

// A first pose from the corners as they were detected, matched within a radius (pixels) of where the prediction expects
// them. Empty when it is not sound.
std::optional<Pose> first_pose(const Frame& frame, const Pose& predicted_camera_from_world, const Rig& rig,
                               const MapView& map, const std::vector<ExpectedPoint>& expected, float radius,
                               const TrackOptions& options);

// How many of the points each keyframe sees, by keyframe. Refills `shared`.
using SharedPoints = std::vector<std::pair<KeyframeId, int>>;
void count_shared_points(const MapView& map, std::span<const TrackedFeature> features, SharedPoints& shared);

// The keyframe that sees most of them; of one map only, unless origin is empty.
std::optional<KeyframeId> most_shared(const SharedPoints& shared, std::optional<Origin> origin = {});

ReusedVector<TrackedFeature> inliers_of(const PoseRefinement& refined, const MeasuredPoints& measured);
ReusedVector<TrackedFeature> outliers_of(const PoseRefinement& refined, const MeasuredPoints& measured);

// Whether the feature was found to show the point itself, and not just to resemble it, as far as patches can tell.
bool shows_patch(const TrackedFeature& feature, const Features& features);

// What is left to the caller: counts of expected points and of matches.
TrackedFrame tracked_frame(const PoseRefinement& refined, ReusedVector<TrackedFeature> inliers, KeyframeId reference,
                           const MapView& map);

}  // namespace byre
