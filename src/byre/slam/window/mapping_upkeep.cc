#include "byre/features/descriptor.h"
#include "byre/geometry/median.h"
#include "byre/slam/window/mapping_steps.h"

#include <algorithm>
#include <limits>

namespace byre {
namespace {

int times_seen(const WindowPoint& point) {
  return static_cast<int>(point.observations.size()) + point.observations_elsewhere + point.foreign_views_elsewhere;
}

// Number of online keyframes that see an online point.
int times_seen_online(const MapWindow& window, const WindowPoint& point) {
  const auto inside = std::ranges::count_if(
      point.observations, [&](const WindowObservation& seen) { return !is_offline(window.keyframe(seen.keyframe)); });
  return static_cast<int>(inside) + point.observations_elsewhere;
}

// Covariance by all views in the window, with exact poses.
Eigen::Matrix3d position_covariance(const MapWindow& window, const WindowPoint& point) {
  constexpr double kPriorSigma = 10.0;  // metres, keeps undetermined directions finite
  Eigen::Matrix3d information = Eigen::Matrix3d::Identity() / (kPriorSigma * kPriorSigma);
  for (const WindowObservation& seen : point.observations) {
    const WindowKeyframe& keyframe = window.keyframe(seen.keyframe);
    const BundleObservation observation = bundle_observation(keyframe, seen.feature);
    const Pose& camera_from_world = keyframe.keyframe.camera_from_world;
    const Eigen::Vector3d point_in_camera = camera_from_world * point.point.position_in_world;
    if (point_in_camera.z() <= 0.0) continue;
    const Eigen::Matrix3d jacobian =
        window.rig_of(keyframe).projection_jacobian(point_in_camera) * camera_from_world.rotation.toRotationMatrix();
    const double pixel_weight = 1.0 / (observation.pixel_sigma * observation.pixel_sigma);
    const double disparity_weight =
        observation.is_stereo() ? 1.0 / (observation.disparity_sigma * observation.disparity_sigma) : 0.0;
    const Eigen::Vector3d weights(pixel_weight, pixel_weight, disparity_weight);
    information += jacobian.transpose() * weights.asDiagonal() * jacobian;
  }
  const Eigen::Matrix3d covariance = information.inverse();
  return 0.5 * (covariance + covariance.transpose());
}

// A single view without a disparity determines only a direction.
bool is_undetermined(const MapWindow& window, const WindowPoint& point) {
  if (times_seen(point) != 1 || point.observations.empty()) return false;
  const WindowObservation& seen = point.observations.front();
  return !window.keyframe(seen.keyframe).keyframe.frame.features->keypoint(seen.feature).has_disparity();
}

// The descriptor with the smallest median distance to the others.
Descriptor most_central_descriptor(const MapWindow& window, const WindowPoint& point) {
  std::vector<const Descriptor*> descriptors;
  for (const WindowObservation& seen : point.observations) {
    descriptors.push_back(&window.keyframe(seen.keyframe).keyframe.frame.features->descriptor(seen.feature));
  }
  const Descriptor* best = &point.point.descriptor;
  int best_median = std::numeric_limits<int>::max();
  std::vector<int> distances(descriptors.size());
  for (const Descriptor* candidate : descriptors) {
    std::ranges::transform(descriptors, distances.begin(),
                           [&](const Descriptor* other) { return hamming_distance(*candidate, *other); });
    const int median = median_of(std::span(distances));
    if (median < best_median) {
      best_median = median;
      best = candidate;
    }
  }
  return *best;
}

void refresh_view(const MapWindow& window, WindowPoint& point) {
  Eigen::Vector3f sum = Eigen::Vector3f::Zero();
  for (const WindowObservation& seen : point.observations) {
    const WindowKeyframe& keyframe = window.keyframe(seen.keyframe);
    const Eigen::Vector3d camera_in_world = inverse(keyframe.keyframe.camera_from_world).translation;
    const Eigen::Vector3f ray = (point.point.position_in_world - camera_in_world).cast<float>();
    sum += ray.normalized();
    if (keyframe.id != point.point.reference.keyframe) continue;
    const Keypoint& keypoint = keyframe.keyframe.frame.features->keypoint(seen.feature);
    point.point.max_distance = ray.norm() * kScaleOfOctave[keypoint.octave];
    point.point.min_distance = point.point.max_distance / kScaleOfOctave.back();
  }
  if (sum.norm() > 1e-3f) point.point.mean_viewing_direction = sum.normalized();
}

// Share of a keyframe's points that are offline, or seen by at least three other online keyframes. Offline keyframes do
// not count, since online points are reached through online ones.
double redundant_share(const MapWindow& window, const WindowKeyframe& keyframe) {
  constexpr int kOthers = 3;
  int seen = 0;
  int redundant = 0;
  for (const int index : keyframe.point_of_feature) {
    if (index < 0) continue;
    ++seen;
    const WindowPoint& point = window.point(index);
    if (is_offline(point) || times_seen_online(window, point) > kOthers) ++redundant;
  }
  return seen == 0 ? 0.0 : static_cast<double>(redundant) / seen;
}

void remove_keyframe(MapWindow& window, int index) {
  WindowKeyframe& keyframe = window.keyframe(index);
  keyframe.removed = true;
  for (int feature = 0; feature < static_cast<int>(keyframe.point_of_feature.size()); ++feature) {
    if (keyframe.point_of_feature[static_cast<std::size_t>(feature)] >= 0) {
      remove_observation(window, {index, feature});
    }
  }
}

// Whether dirt hides the point in the window's first keyframe.
bool is_behind_dirt(const MapWindow& window, const WindowPoint& point, const ImageMask& hidden) {
  if (!hidden.any()) return false;
  const WindowKeyframe& keyframe = window.keyframes.front();
  const Eigen::Vector3d in_camera = keyframe.keyframe.camera_from_world * point.point.position_in_world;
  if (in_camera.z() <= 0.0) return false;
  const Rig& rig = window.rig_of(keyframe);
  const Eigen::Vector2d pixel = rig.project(in_camera).head<2>();
  return rig.contains(pixel) && hidden.hides(pixel, rig);
}

}  // namespace

void refresh_points(MapWindow& window) {
  for (WindowPoint& point : window.points) {
    if (point.removed || is_offline(point) || point.observations.empty()) continue;
    point.point.covariance = position_covariance(window, point);
    refresh_view(window, point);
    if (point.observations_elsewhere == 0) point.point.descriptor = most_central_descriptor(window, point);
  }
}

void remove_weak_points(MapWindow& window, KeyframeId newest, const ImageMask& hidden) {
  constexpr std::uint32_t kKeyframesToConfirm = 3;
  for (int i = 0; i < static_cast<int>(window.points.size()); ++i) {
    const WindowPoint& point = window.point(i);
    if (point.removed || is_offline(point)) continue;
    const bool had_its_chance = newest.number >= point.point.reference.keyframe.number + kKeyframesToConfirm;
    const bool alone = !point.id && times_seen(point) < 2;  // made in this window and rejected at once
    const bool unconfirmed = had_its_chance && times_seen(point) < 2 && !is_behind_dirt(window, point, hidden);
    if (alone || unconfirmed || is_undetermined(window, point)) remove_point(window, i);
  }
}

void remove_redundant_keyframes(MapWindow& window, const MappingOptions& options) {
  for (int i = 1; i < static_cast<int>(window.keyframes.size()); ++i) {
    const WindowKeyframe& keyframe = window.keyframe(i);
    if (!keyframe.movable || keyframe.is_new) continue;
    if (redundant_share(window, keyframe) > options.redundant_share) remove_keyframe(window, i);
  }
}

}  // namespace byre
