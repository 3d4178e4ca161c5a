#include "byre/slam/tracking.h"

#include "byre/features/match.h"
#include "byre/geometry/absolute_pose.h"
#include "byre/slam/guided_matching.h"
#include "byre/slam/measurement.h"

#include <algorithm>
#include <map>

namespace byre {
namespace {

PoseObservation pose_observation(const MapPoint& point, const Keypoint& keypoint, const PixelMeasurement& pixel) {
  PoseObservation observation;
  observation.point_in_world = point.position_in_world;
  observation.point_covariance = point.covariance;
  observation.measured << pixel.pixel.cast<double>(), keypoint.disparity;
  observation.pixel_sigma = pixel.sigma;
  observation.disparity_sigma = keypoint.has_disparity() ? keypoint.disparity_sigma : -1.0;
  return observation;
}

bool is_sound(const PoseRefinement& refined, std::size_t matches, const TrackOptions& options) {
  return refined.inlier_count >= options.min_inliers &&
         refined.inlier_count >= options.min_inlier_share * static_cast<double>(matches);
}

// A first pose from the corners as they were detected, matched within a radius of where the prediction expects them.
std::optional<Pose> first_pose(const Frame& frame, const Pose& predicted_camera_from_world, const Rig& rig,
                               const MapView& map, const std::vector<ExpectedPoint>& expected, float radius,
                               const TrackOptions& options) {
  const std::vector<GuidedMatch> matches = match_expected(*frame.features, map, expected, {radius});
  std::vector<PoseObservation> observations;
  observations.reserve(matches.size());
  for (const GuidedMatch& match : matches) {
    const Keypoint& keypoint = frame.features->keypoint(match.feature);
    observations.push_back(pose_observation(*map.find_point(match.point), keypoint, corner_measurement(keypoint)));
  }
  const auto refined = refine_pose(predicted_camera_from_world, rig, observations, options.refinement);
  if (!refined || !is_sound(*refined, matches.size(), options)) return std::nullopt;
  return refined->camera_from_world;
}

// The pixel of the point in the frame, by its reference patch where that keyframe still exists.
PixelMeasurement measure(const MapView& map, const MapPoint& point, const CameraView& frame, int feature) {
  const Keyframe* const keyframe = map.find_keyframe(point.reference.keyframe);
  if (keyframe == nullptr) return corner_measurement(frame.features.keypoint(feature));
  const CameraView view{*keyframe->frame.features, map.rig_of(*keyframe, point.reference.keyframe),
                        keyframe->camera_from_world};
  const Sighting& sighting = keyframe->sightings[static_cast<std::size_t>(point.reference.feature)];
  return measure_pixel({view, point.reference.feature, sighting.pixel}, point.position_in_world, frame, feature);
}

KeyframeId most_shared(const MapView& map, const std::vector<TrackedFeature>& features) {
  std::map<KeyframeId, int> votes;
  for (const TrackedFeature& feature : features) {
    map.visit_observations(feature.point, [&](const Observation& observation) { ++votes[observation.keyframe]; });
  }
  const auto best =
      std::max_element(votes.begin(), votes.end(), [](const auto& a, const auto& b) { return a.second < b.second; });
  return best == votes.end() ? KeyframeId{} : best->first;
}

std::optional<TrackedFrame> refine_on_matches(const Frame& frame, const Pose& camera_from_world, const Rig& rig,
                                              const MapView& map, const std::vector<GuidedMatch>& matches,
                                              const TrackOptions& options) {
  const CameraView view{*frame.features, rig, camera_from_world};
  std::vector<PoseObservation> observations;
  std::vector<TrackedFeature> features;
  observations.reserve(matches.size());
  features.reserve(matches.size());
  for (const GuidedMatch& match : matches) {
    const MapPoint& point = *map.find_point(match.point);
    const PixelMeasurement pixel = measure(map, point, view, match.feature);
    observations.push_back(pose_observation(point, frame.features->keypoint(match.feature), pixel));
    features.push_back({match.feature, match.point, pixel.pixel, pixel.sigma});
  }
  const auto refined = refine_pose(camera_from_world, rig, observations, options.refinement);
  if (!refined || !is_sound(*refined, matches.size(), options)) return std::nullopt;

  TrackedFrame tracked;
  tracked.camera_from_world = refined->camera_from_world;
  tracked.covariance = refined->covariance;
  tracked.match_covariance = refined->covariance;
  tracked.matches = static_cast<int>(matches.size());
  for (std::size_t i = 0; i < features.size(); ++i) {
    if (refined->inliers[i]) tracked.features.push_back(features[i]);
  }
  tracked.reference = most_shared(map, tracked.features);
  if (const Keyframe* const reference = map.find_keyframe(tracked.reference)) {
    tracked.covariance +=
        move_covariance(reference->covariance, tracked.camera_from_world * inverse(reference->camera_from_world));
  }
  return tracked;
}

}  // namespace

std::vector<PointId> local_points(const MapView& map, KeyframeId reference, int max_keyframes) {
  std::vector<PointId> points;
  const auto append = [&](KeyframeId id) {
    const Keyframe* const keyframe = map.find_keyframe(id);
    if (keyframe == nullptr) return;
    for (const Sighting& sighting : keyframe->sightings) {
      if (sighting.point) points.push_back(*sighting.point);
    }
  };
  append(reference);
  for (const Covisible& neighbour : map.covisible_keyframes(reference, max_keyframes - 1)) append(neighbour.keyframe);
  std::sort(points.begin(), points.end());
  points.erase(std::unique(points.begin(), points.end()), points.end());
  return points;
}

std::optional<TrackedFrame> track(const Frame& frame, const Pose& predicted_camera_from_world, const Rig& rig,
                                  const MapView& map, const std::vector<PointId>& candidates,
                                  const TrackOptions& options) {
  const std::vector<ExpectedPoint> predicted = project_points(map, candidates, predicted_camera_from_world, rig);
  std::optional<Pose> first;
  for (const float radius : {options.search_radius, options.wide_radius}) {
    if (!first) first = first_pose(frame, predicted_camera_from_world, rig, map, predicted, radius, options);
  }
  if (!first) return std::nullopt;

  const std::vector<ExpectedPoint> expected = project_points(map, candidates, *first, rig);
  const std::vector<GuidedMatch> matches =
      match_expected(*frame.features, map, expected, {options.narrow_radius, 90, 0.9f});
  auto tracked = refine_on_matches(frame, *first, rig, map, matches, options);
  if (tracked) tracked->expected = static_cast<int>(expected.size());
  return tracked;
}

std::optional<Pose> pose_from_keyframe(const Frame& frame, const Rig& rig, const MapView& map, KeyframeId id) {
  const Keyframe* const keyframe = map.find_keyframe(id);
  if (keyframe == nullptr) return std::nullopt;
  std::vector<PointSighting> sightings;
  for (const Match& match : match_features(*keyframe->frame.features, *frame.features, {})) {
    const auto& point_id = keyframe->sightings[static_cast<std::size_t>(match.first)].point;
    const MapPoint* const point = point_id ? map.find_point(*point_id) : nullptr;
    if (point == nullptr) continue;
    sightings.push_back({point->position_in_world, frame.features->keypoint(match.second).pixel.cast<double>()});
  }
  constexpr int kMinInliers = 15;
  const auto pose = estimate_absolute_pose(sightings, rig, {});
  if (!pose || pose->inlier_count < kMinInliers) return std::nullopt;
  return pose->camera_from_world;
}

}  // namespace byre
