#include "byre/map/map_file.h"

#include <cassert>

namespace byre {
namespace {

// Of a small motion, translation first.
Matrix6 scaled_covariance(const Matrix6& covariance, double factor) {
  Vector6 units = Vector6::Ones();
  units.head<3>().setConstant(factor);
  return units.asDiagonal() * covariance * units.asDiagonal();
}

}  // namespace

Map scaled_copy(const Map& map, double factor) {
  assert(factor > 0.0);
  Map scaled = map;
  for (const KeyframeId id : map.keyframe_ids()) {
    const Keyframe& keyframe = *map.find_keyframe(id);
    Pose camera_from_world = keyframe.camera_from_world;
    camera_from_world.translation *= factor;
    scaled.move_keyframe(id, camera_from_world, scaled_covariance(keyframe.covariance, factor));
  }
  for (const PointId id : map.point_ids()) {
    MapPoint point = *map.find_point(id);
    point.position_in_world *= factor;
    point.covariance *= factor * factor;
    point.min_distance *= static_cast<float>(factor);
    point.max_distance *= static_cast<float>(factor);
    scaled.update_point(id, point);
  }
  return scaled;
}

}  // namespace byre
