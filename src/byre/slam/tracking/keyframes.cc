#include "byre/slam/tracking/keyframes.h"

#include "byre/geometry/median.h"
#include "byre/slam/tracking/measurement.h"

#include <algorithm>
#include <utility>

namespace byre {
namespace {

// Largest relative sigma of a disparity that gives a point by itself.
constexpr float kMaxRelativeDisparitySigma = 0.2f;

bool has_trustworthy_disparity(const Keypoint& keypoint) {
  return keypoint.has_disparity() && keypoint.disparity_sigma < kMaxRelativeDisparitySigma * keypoint.disparity;
}

// Covariance of a point triangulated from (u, v, disparity), in world.
Eigen::Matrix3d stereo_covariance(const Rig& rig, const Pose& camera_from_world, const Eigen::Vector3d& point_in_camera,
                                  double pixel_sigma, double disparity_sigma) {
  const Eigen::Matrix3d point_from_pixel = rig.projection_jacobian(point_in_camera).inverse();
  const Eigen::Vector3d variances(pixel_sigma * pixel_sigma, pixel_sigma * pixel_sigma,
                                  disparity_sigma * disparity_sigma);
  const Eigen::Matrix3d world_from_pixel = camera_from_world.rotation.conjugate().toRotationMatrix() * point_from_pixel;
  return world_from_pixel * variances.asDiagonal() * world_from_pixel.transpose();
}

}  // namespace

bool needs_keyframe(const TrackedFrame& tracked, const KeyframeEvidence& evidence, const KeyframeOptions& options) {
  if (evidence.offline_inliers >= kEnoughOffline) return false;
  const int inliers = static_cast<int>(tracked.features.size());
  const bool weak = inliers < options.min_tracked && evidence.offline_inliers < kManyOffline;
  if (evidence.pending >= (weak ? kMaxPendingWhenWeak : kMaxPending)) return false;
  if (weak) return true;
  if (evidence.frames_since_last < options.min_frames) return false;
  if (evidence.without_depth > 0 && evidence.without_depth <= kMaxWaitForDepth) return false;
  const bool has_lost_points = inliers < options.min_tracked_share * evidence.fresh_inliers;
  return (has_lost_points && evidence.offline_inliers < kManyOffline) || evidence.turn > options.max_turn ||
         evidence.shift_share > options.max_shift_share;
}

double median_depth(const TrackedFrame& tracked, const MapView& map) {
  ScratchVector<double> depths;
  depths.reserve(tracked.features.size());
  for (const TrackedFeature& feature : tracked.features) {
    const MapPoint* const point = map.find_point(feature.point);
    if (point != nullptr) depths.push_back((tracked.camera_from_world * point->position_in_world).z());
  }
  return depths.empty() ? 0.0 : median_of(std::span(depths));
}

Keyframe make_keyframe(const Frame& frame, const TrackedFrame& tracked, int rig) {
  Keyframe keyframe;
  keyframe.frame = frame;
  keyframe.rig = rig;
  keyframe.camera_from_world = tracked.camera_from_world;
  keyframe.covariance = tracked.covariance;
  keyframe.parent = tracked.reference;
  for (int i = 0; i < frame.features->size(); ++i) {
    keyframe.sightings.push_back(
        {std::nullopt, frame.features->keypoint(i).pixel, reference_sigma(*frame.features, i)});
  }
  for (const TrackedFeature& feature : tracked.features) {
    keyframe.sightings[static_cast<std::size_t>(feature.feature)] = {feature.point, feature.pixel, feature.pixel_sigma};
  }
  return keyframe;
}

KeyframeId add_keyframe_at(const Pose& camera_from_world, const Frame& frame, const Rig& rig,
                           std::optional<KeyframeId> parent, MapGraph& map, int recording) {
  TrackedFrame without_points;
  without_points.camera_from_world = camera_from_world;
  Keyframe keyframe = make_keyframe(frame, without_points, map.add_rig(rig));
  keyframe.parent = parent;
  keyframe.recording = recording;
  return map.add_keyframe(std::move(keyframe));
}

MapPoint make_point(const Eigen::Vector3d& position_in_world, const Eigen::Matrix3d& covariance,
                    const Observation& reference, const Features& features, const Pose& camera_from_world) {
  const Eigen::Vector3d ray = position_in_world - inverse(camera_from_world).translation;
  const float distance = static_cast<float>(ray.norm());
  MapPoint point;
  point.position_in_world = position_in_world;
  point.covariance = covariance;
  point.mean_viewing_direction = (ray / ray.norm()).cast<float>();
  point.descriptor = features.descriptor(reference.feature);
  point.max_distance = distance * kScaleOfOctave[features.keypoint(reference.feature).octave];
  point.min_distance = point.max_distance / kScaleOfOctave.back();
  point.reference = reference;
  return point;
}

int add_stereo_points(MapGraph& map, KeyframeId id, std::span<const int> moving) {
  const Keyframe keyframe = *map.find_keyframe(id);  // a copy: adding observations changes the original
  const Rig rig = map.rigs()[static_cast<std::size_t>(keyframe.rig)];
  const Pose world_from_camera = inverse(keyframe.camera_from_world);
  int added = 0;
  for (int feature = 0; feature < keyframe.frame.features->size(); ++feature) {
    const Keypoint& keypoint = keyframe.frame.features->keypoint(feature);
    if (keyframe.sightings[static_cast<std::size_t>(feature)].point || !has_trustworthy_disparity(keypoint)) continue;
    if (std::ranges::binary_search(moving, feature)) continue;
    const Eigen::Vector3d point_in_camera =
        rig.triangulate({keypoint.pixel.x(), keypoint.pixel.y(), keypoint.disparity});
    const float sigma = reference_sigma(*keyframe.frame.features, feature);
    const Eigen::Matrix3d covariance =
        stereo_covariance(rig, keyframe.camera_from_world, point_in_camera, sigma, keypoint.disparity_sigma);
    const PointId point = map.add_point(make_point(world_from_camera * point_in_camera, covariance, {id, feature},
                                                   *keyframe.frame.features, keyframe.camera_from_world));
    map.add_observation({id, feature}, {point, keypoint.pixel, sigma});
    ++added;
  }
  return added;
}

std::optional<MapGraph> initialise_stereo(const Frame& frame, const Rig& rig, int min_points) {
  const auto& keypoints = frame.features->keypoints();
  if (std::count_if(keypoints.begin(), keypoints.end(), has_trustworthy_disparity) < min_points) return std::nullopt;
  MapGraph map(Origin::online);
  // The world is the first body frame.
  add_stereo_points(map, add_keyframe_at(inverse(rig.body_from_camera), frame, rig, std::nullopt, map));
  return map;
}

}  // namespace byre
