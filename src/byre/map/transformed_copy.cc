#include "byre/map/transformed_copy.h"

#include "byre/map/mapped_tag.h"
#include "byre/map/scaled_copy.h"

namespace byre {
namespace {

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
