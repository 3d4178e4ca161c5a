#include "byre/map/scaled_copy.h"

#include "byre/map/mapped_tag.h"
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

void move(MapGraph& map, const Pose& target_from_map) {
  const Pose map_from_target = inverse(target_from_map);
  for (const KeyframeId id : map.keyframe_ids()) {
    const Keyframe& keyframe = *map.find_keyframe(id);
    map.move_keyframe(id, keyframe.camera_from_world * map_from_target, keyframe.covariance);
  }
  for (const PointId id : map.point_ids()) {
    MapPoint point = moved(*map.find_point(id), target_from_map);
    point.covariance = Eigen::Matrix3d(point.covariance).selfadjointView<Eigen::Upper>();  // exactly symmetric
    map.update_point(id, point);
  }
}

// A change of the scale moves points away from the map's origin, so a translation of the origin correlates both.
PlanRegistration moved(PlanRegistration registration, const Pose& target_from_map) {
  const double scale = registration.plan_from_map.scale;
  const Pose target_from_map_in_metres = scale_lengths(target_from_map, scale);
  Matrix7 jacobian = Matrix7::Identity();
  jacobian.topLeftCorner<6, 6>() = adjoint(target_from_map_in_metres);
  jacobian.topRightCorner<3, 1>() = -target_from_map_in_metres.translation;
  Pose& plan_from_map = registration.plan_from_map.target_from_source;
  plan_from_map = plan_from_map * inverse(target_from_map_in_metres);
  const Matrix7 covariance = jacobian * registration.covariance * jacobian.transpose();
  registration.covariance = covariance.selfadjointView<Eigen::Upper>();
  return registration;
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

MapPoint moved(MapPoint point, const Pose& target_from_world) {
  const Eigen::Matrix3d turn = target_from_world.rotation.toRotationMatrix();
  point.position_in_world = target_from_world * point.position_in_world;
  point.mean_viewing_direction = target_from_world.rotation.cast<float>() * point.mean_viewing_direction;
  point.covariance = turn * point.covariance * turn.transpose();
  return point;
}

StoredMap transformed_copy(const StoredMap& stored, const Similarity& target_from_map) {
  StoredMap result = target_from_map.scale == 1.0 ? stored : scaled_copy(stored, target_from_map.scale);
  move(result.map, target_from_map.target_from_source);
  if (result.plan) result.plan = moved(*result.plan, target_from_map.target_from_source);
  write_tags(moved(stored_tags(result.notes), {1.0, target_from_map.target_from_source}), result.notes);
  return result;
}

}  // namespace byre
