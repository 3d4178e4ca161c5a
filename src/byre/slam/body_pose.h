#pragma once

#include "byre/rig.h"

namespace byre {

// world_from_body, where the left camera stands.
inline Pose body_pose(const Rig& rig, const Pose& camera_from_world) {
  return inverse(rig.body_from_camera * camera_from_world);
}

// camera_from_world, where the body stands.
inline Pose camera_pose(const Rig& rig, const Pose& world_from_body) {
  return inverse(world_from_body * rig.body_from_camera);
}

}  // namespace byre
