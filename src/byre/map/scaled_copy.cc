#include "byre/map/scaled_copy.h"

#include "byre/geometry/alignment.h"

#include <cassert>
#include <cmath>
#include <utility>

namespace byre {
namespace {

// A factor within this of one is rounding.
constexpr double kSame = 1e-12;

MapPoint scaled_copy(MapPoint point, double factor) {
  point.position_in_world *= factor;
  point.covariance *= factor * factor;
  point.min_distance *= static_cast<float>(factor);
  point.max_distance *= static_cast<float>(factor);
  return point;
}

bool is_same(const Camera& first, const Camera& second) {
  return first.model == second.model && first.width == second.width && first.height == second.height &&
         first.fx == second.fx && first.fy == second.fy && first.cx == second.cx && first.cy == second.cy &&
         first.distortion == second.distortion;
}

bool is_same(const Pose& first, const Pose& second) {
  return first.rotation.coeffs() == second.rotation.coeffs() && first.translation == second.translation;
}

bool is_same_pair(const Calibration& first, const Calibration& second) {
  return first.right && second.right && is_same(first.left, second.left) &&
         is_same(first.right->camera, second.right->camera) &&
         is_same(first.right->right_from_left, second.right->right_from_left);
}

}  // namespace

Calibration scaled(const Calibration& calibration, double factor) {
  assert(factor > 0.0);
  Calibration scaled = calibration;
  if (scaled.right) scaled.right->right_from_left.translation *= factor;
  return scaled;
}

Map scaled_copy(const Map& map, double factor) {
  assert(factor > 0.0);
  MapParts parts{map.rigs(), {}, {}};
  for (Rig& rig : parts.rigs) rig.baseline *= factor;
  for (const KeyframeId id : map.keyframe_ids()) {
    Keyframe keyframe = *map.find_keyframe(id);
    keyframe.camera_from_world = scale_lengths(keyframe.camera_from_world, factor);
    keyframe.covariance = scale_lengths(keyframe.covariance, factor);
    parts.keyframes.push_back(std::move(keyframe));
  }
  for (const PointId id : map.point_ids()) parts.points.push_back(scaled_copy(*map.find_point(id), factor));
  return {map.origin(), std::move(parts)};
}

StoredMap scaled_copy(const StoredMap& stored, double factor) {
  StoredMap scaled = stored;
  scaled.map = scaled_copy(stored.map, factor);
  if (scaled.plan) scaled.plan->plan_from_map.scale /= factor;
  return scaled;
}

double baseline_factor(const StoredMap& stored, std::size_t recording) {
  const Calibration& given = stored.recordings.at(recording).calibration;
  if (!given.right) return 1.0;
  for (const KeyframeId id : stored.map.keyframe_ids()) {
    const Keyframe& keyframe = *stored.map.find_keyframe(id);
    const Rig& rig = stored.map.rigs()[static_cast<std::size_t>(keyframe.rig)];
    if (std::cmp_not_equal(keyframe.recording, recording) || !rig.is_stereo()) continue;
    const double factor = rig.baseline / given.right->right_from_left.translation.norm();
    return std::abs(factor - 1.0) < kSame ? 1.0 : factor;
  }
  return 1.0;
}

Calibration calibration_on(const StoredMap& stored, const Calibration& given) {
  for (std::size_t i = 0; i < stored.recordings.size(); ++i) {
    if (!is_same_pair(stored.recordings[i].calibration, given)) continue;
    return scaled(given, baseline_factor(stored, i));
  }
  return given;
}

}  // namespace byre
