#include "byre/slam/tracking/tracking_steps.h"

#include <algorithm>

namespace byre {
namespace {

constexpr double kMinInlierShare = 0.5;  // share of the matches; with fewer the prediction was wrong

PoseObservation observation_of(const MapPoint& point, const Keypoint& keypoint, const PixelMeasurement& pixel) {
  const StereoPixel measured(pixel.pixel.x(), pixel.pixel.y(), keypoint.disparity);
  return pose_observation(point, measured, pixel.sigma, keypoint.has_disparity() ? keypoint.disparity_sigma : -1.0);
}

// Measures the pixel of the point in the frame.
PixelMeasurement measure(const MapView& map, const MapPoint& point, const CameraView& frame, int feature) {
  const Keyframe* const keyframe = map.find_keyframe(point.reference.keyframe);
  if (keyframe == nullptr) return corner_measurement(frame.features.keypoint(feature));
  const CameraView view{*keyframe->frame.features, map.rig_of(*keyframe, point.reference.keyframe),
                        keyframe->camera_from_world};
  const Sighting& sighting = keyframe->sightings[static_cast<std::size_t>(point.reference.feature)];
  return measure_pixel({view, point.reference.feature, sighting.pixel}, point.position_in_world, frame, feature);
}

// Adds the error of the pose to that of the point: only their relative position shows in the image.
void add_pose_error(PoseObservation& observation, const Pose& camera_from_world, const Matrix6& covariance) {
  Eigen::Matrix<double, 3, 6> by_pose;
  by_pose << Eigen::Matrix3d::Identity(), -skew(camera_from_world * observation.point_in_world);
  by_pose = camera_from_world.rotation.conjugate().toRotationMatrix() * by_pose;
  observation.point_covariance += by_pose * covariance * by_pose.transpose();
}

ScratchVector<TrackedFeature> matches_by(const PoseRefinement& refined, const MeasuredPoints& measured,
                                         bool agreement) {
  ScratchVector<TrackedFeature> matches;
  matches.reserve(measured.features.size());
  for (std::size_t i = 0; i < measured.features.size(); ++i) {
    if (static_cast<bool>(refined.inliers[i]) == agreement) matches.push_back(measured.features[i]);
  }
  return matches;
}

}  // namespace

PoseObservation pose_observation(const MapPoint& point, const StereoPixel& measured, double pixel_sigma,
                                 double disparity_sigma) {
  PoseObservation observation;
  observation.point_in_world = point.position_in_world;
  observation.point_covariance = point.covariance;
  observation.measured = measured;
  observation.pixel_sigma = pixel_sigma;
  observation.disparity_sigma = disparity_sigma;
  return observation;
}

ScratchVector<ExpectedPoint> project_visible(const MapView& map, std::span<const PointId> points,
                                             const Pose& camera_from_world, const Rig& rig, const ImageMask& hidden) {
  ScratchVector<ExpectedPoint> expected = project_points(map, points, camera_from_world, rig);
  if (!hidden.any()) return expected;
  std::erase_if(expected,
                [&](const ExpectedPoint& point) { return hidden.hides(point.projection.predicted.head<2>(), rig); });
  return expected;
}

MeasuredPoints measure_matches(const Frame& frame, const Pose& camera_from_world, const Rig& rig, const MapView& map,
                               std::span<const PointMatch> matches) {
  const CameraView view{*frame.features, rig, camera_from_world};
  MeasuredPoints measured;
  measured.observations.reserve(matches.size());
  measured.features.reserve(matches.size());
  for (const PointMatch& match : matches) {
    const MapPoint& point = *map.find_point(match.point);
    const PixelMeasurement pixel = measure(map, point, view, match.feature);
    if (match.point.origin == Origin::offline && pixel.differs) continue;
    measured.observations.push_back(observation_of(point, frame.features->keypoint(match.feature), pixel));
    measured.features.push_back({match.feature, match.point, pixel.pixel, pixel.sigma});
  }
  return measured;
}

PartedPoints part_by_agreement(const Pose& camera_from_world, const Matrix6& covariance, const Rig& rig,
                               const MeasuredPoints& measured, double max_variance_factor) {
  PoseRefinementOptions at_pose;
  at_pose.rounds = 0;
  at_pose.max_variance_factor = max_variance_factor;
  std::span<const PoseObservation> observations = measured.observations;
  ScratchVector<PoseObservation> widened;
  if (!covariance.isZero(0.0)) {
    widened.assign(observations.begin(), observations.end());
    for (PoseObservation& observation : widened) add_pose_error(observation, camera_from_world, covariance);
    observations = widened;
  }
  const auto judged = refine_pose(camera_from_world, rig, observations, at_pose);
  PartedPoints parted;
  for (std::size_t i = 0; i < measured.features.size(); ++i) {
    if (!judged || !judged->inliers[i]) {
      parted.disagreeing.push_back(measured.features[i]);
      continue;
    }
    parted.agreeing.observations.push_back(measured.observations[i]);
    parted.agreeing.features.push_back(measured.features[i]);
  }
  return parted;
}

bool is_sound(const PoseRefinement& refined, std::size_t matches, int min_inliers) {
  return refined.inlier_count >= min_inliers && refined.inlier_count >= kMinInlierShare * static_cast<double>(matches);
}

std::optional<Pose> first_pose(const Frame& frame, const Pose& predicted_camera_from_world, const Rig& rig,
                               const MapView& map, std::span<const ExpectedPoint> expected,
                               const TrackOptions& options) {
  for (const float radius : {options.search_radius, options.wide_radius}) {
    const ScratchVector<PointMatch> matches = match_expected(*frame.features, map, expected, {radius});
    ScratchVector<PoseObservation> observations;
    observations.reserve(matches.size());
    for (const PointMatch& match : matches) {
      const Keypoint& keypoint = frame.features->keypoint(match.feature);
      observations.push_back(observation_of(*map.find_point(match.point), keypoint, corner_measurement(keypoint)));
    }
    const auto refined = refine_pose(predicted_camera_from_world, rig, observations, {});
    if (refined && is_sound(*refined, matches.size(), options.min_inliers)) return refined->camera_from_world;
  }
  return std::nullopt;
}

SharedPoints count_shared_points(const MapView& map, std::span<const TrackedFeature> features) {
  SharedPoints shared;
  for (const TrackedFeature& feature : features) {
    map.visit_observations(feature.point, [&](const Observation& observation) {
      const auto at = std::ranges::lower_bound(shared, observation.keyframe, {}, &std::pair<KeyframeId, int>::first);
      if (at != shared.end() && at->first == observation.keyframe) {
        ++at->second;
      } else {
        shared.insert(at, {observation.keyframe, 1});
      }
    });
  }
  return shared;
}

std::optional<KeyframeId> most_shared(const SharedPoints& shared, std::optional<Origin> origin) {
  std::optional<KeyframeId> best;
  int most = 0;
  for (const auto& [keyframe, count] : shared) {
    if (count <= most || (origin && keyframe.origin != *origin)) continue;
    best = keyframe;
    most = count;
  }
  return best;
}

ScratchVector<TrackedFeature> inliers_of(const PoseRefinement& refined, const MeasuredPoints& measured) {
  return matches_by(refined, measured, true);
}

ScratchVector<TrackedFeature> outliers_of(const PoseRefinement& refined, const MeasuredPoints& measured) {
  return matches_by(refined, measured, false);
}

bool shows_patch(const TrackedFeature& feature, const Features& features) {
  return features.find_patch(feature.feature) == nullptr ||
         feature.pixel_sigma < corner_measurement(features.keypoint(feature.feature)).sigma;
}

TrackedFrame tracked_frame(const PoseRefinement& refined, ScratchVector<TrackedFeature> inliers, KeyframeId reference,
                           const MapView& map) {
  TrackedFrame tracked;
  tracked.camera_from_world = refined.camera_from_world;
  tracked.covariance = refined.covariance;
  tracked.match_covariance = refined.covariance;
  tracked.features = std::move(inliers);
  tracked.reference = reference;
  if (const Keyframe* const keyframe = map.find_keyframe(reference)) {
    tracked.covariance +=
        move_covariance(keyframe->covariance, tracked.camera_from_world * inverse(keyframe->camera_from_world));
  }
  return tracked;
}

}  // namespace byre
