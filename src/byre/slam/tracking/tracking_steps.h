#pragma once

#include "byre/base/scratch_memory.h"
#include "byre/slam/tracking/guided_matching.h"
#include "byre/slam/tracking/measurement.h"
#include "byre/slam/tracking/tracking.h"

#include <optional>
#include <span>
#include <utility>

// Steps shared by tracking on one map and on two.
namespace byre {

inline constexpr float kNarrowRadius = 4.0f;  // pixels at octave 0, around the projection from a first pose

PoseObservation pose_observation(const MapPoint& point, const StereoPixel& measured, double pixel_sigma,
                                 double disparity_sigma);

// Same as project_points(), without hidden points.
ScratchVector<ExpectedPoint> project_visible(const MapView& map, std::span<const PointId> points,
                                             const Pose& camera_from_world, const Rig& rig, const ImageMask& hidden);

// Matches measured in the image: observations, and the features that inliers become; equal indices.
struct MeasuredPoints {
  ScratchVector<PoseObservation> observations;
  ScratchVector<TrackedFeature> features;
};

// Measures each match by its point's reference patch if that keyframe still exists, else by its corner. Matches of
// offline points whose patch does not fit are left out: five of six are wrong, because the map was made in another
// light and from another place. Chance matches around a prediction confirm it.
MeasuredPoints measure_matches(const Frame& frame, const Pose& camera_from_world, const Rig& rig, const MapView& map,
                               std::span<const PointMatch> matches);

// Matches split by agreement with a given pose.
struct PartedPoints {
  MeasuredPoints agreeing;
  ScratchVector<TrackedFeature> disagreeing;
};

// covariance: of delta in exp_pose(delta) * camera_from_world; zero: the pose is exact. max_variance_factor: factor on
// the variances of the measurements, that of the points that gave the pose.
PartedPoints part_by_agreement(const Pose& camera_from_world, const Matrix6& covariance, const Rig& rig,
                               const MeasuredPoints& measured, double max_variance_factor);

// Whether enough of the matches agree on the pose.
bool is_sound(const PoseRefinement& refined, std::size_t matches, int min_inliers);

// First pose from detected corners, matched within the search radius around the predictions, otherwise within the wide
// one. Empty if neither pose is sound.
std::optional<Pose> first_pose(const Frame& frame, const Pose& predicted_camera_from_world, const Rig& rig,
                               const MapView& map, std::span<const ExpectedPoint> expected,
                               const TrackOptions& options);

// Number of the points that each keyframe sees, by keyframe.
using SharedPoints = ScratchVector<std::pair<KeyframeId, int>>;
SharedPoints count_shared_points(const MapView& map, std::span<const TrackedFeature> features);

// The keyframe that sees most of them; of one map only if origin is given.
std::optional<KeyframeId> most_shared(const SharedPoints& shared, std::optional<Origin> origin = {});

ScratchVector<TrackedFeature> inliers_of(const PoseRefinement& refined, const MeasuredPoints& measured);
ScratchVector<TrackedFeature> outliers_of(const PoseRefinement& refined, const MeasuredPoints& measured);

// Whether the feature shows the point itself by its patch, not only a similar corner.
bool shows_patch(const TrackedFeature& feature, const Features& features);

// Counts of expected points and of matches are left to the caller.
TrackedFrame tracked_frame(const PoseRefinement& refined, ScratchVector<TrackedFeature> inliers, KeyframeId reference,
                           const MapView& map);

}  // namespace byre
