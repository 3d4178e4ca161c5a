#include "byre/map/scaled_copy.h"

#include "byre/map/mapped_tag.h"
#include "byre/map/transformed_copy.h"
#include "byre/odometry/odometry_calibration.h"

#include <cassert>
#include <cmath>
#include <utility>

namespace byre {
namespace {

// Smaller deviations of a factor from one are rounding errors.
constexpr double kSame = 1e-12;

MapPoint scaled_copy(MapPoint point, double factor) {
  point.position_in_world *= factor;
  point.covariance *= factor * factor;
  point.min_distance *= static_cast<float>(factor);
  point.max_distance *= static_cast<float>(factor);
  return point;
}

}  // namespace

Calibration scaled(const Calibration& calibration, double factor) {
  assert(factor > 0.0);
  Calibration scaled = calibration;
  if (scaled.right) scaled.right->right_from_left.translation *= factor;
  return scaled;
}

MapGraph scaled_copy(const MapGraph& map, double factor) {
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
  for (SourceRecording& recording : scaled.recordings) {
    if (!recording.calibration.right) continue;
    if (!recording.refined) recording.refined = RefinedCalibration{.calibration = recording.calibration};
    recording.refined->calibration = byre::scaled(recording.refined->calibration, factor);
  }
  scaled.notes.erase(kMetresNote);  // the scale no longer comes from wheels
  write_odometry_calibration(byre::scaled(read_odometry_calibration(stored.notes), factor), scaled.notes);
  write_tags(moved(stored_tags(stored.notes), {factor, {}}), scaled.notes);
  if (scaled.plan) scaled.plan->plan_from_map.scale /= factor;
  return scaled;
}

void rescale(MapGraph& map, double factor) {
  assert(factor > 0.0);
  for (KeyframeId id{map.origin(), 0}; map.living_ancestor(id); ++id.number) {
    const Keyframe* const keyframe = map.find_keyframe(id);
    if (keyframe == nullptr) {
      map.scale_removed_keyframe(id, factor);
    } else {
      map.move_keyframe(id, scale_lengths(keyframe->camera_from_world, factor),
                        scale_lengths(keyframe->covariance, factor));
    }
  }
  for (const PointId id : map.point_ids()) map.update_point(id, scaled_copy(*map.find_point(id), factor));
}

void move_part(MapGraph& map, const Similarity& after_from_before, const std::function<bool(KeyframeId)>& is_moved) {
  const double scale = after_from_before.scale;
  for (KeyframeId id{map.origin(), 0}; map.living_ancestor(id); ++id.number) {
    if (!is_moved(id)) continue;
    const Keyframe* const keyframe = map.find_keyframe(id);
    if (keyframe == nullptr) {
      map.scale_removed_keyframe(id, scale);
    } else {
      map.move_keyframe(id, move_camera(after_from_before, keyframe->camera_from_world),
                        scale_lengths(keyframe->covariance, scale));
    }
  }
  for (const PointId id : map.point_ids()) {
    const MapPoint& point = *map.find_point(id);
    if (!is_moved(point.reference.keyframe)) continue;
    map.update_point(id, moved(scaled_copy(point, scale), after_from_before.target_from_source));
  }
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

}  // namespace byre
