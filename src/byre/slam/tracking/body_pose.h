#pragma once

#include "byre/rig.h"

namespace byre {

// Pose world_from_body for a pose of the left camera.
inline Pose body_pose(const Rig& rig, const Pose& camera_from_world) {
  return inverse(rig.body_from_camera * camera_from_world);
}

// Pose camera_from_world for a pose of the body.
inline Pose camera_pose(const Rig& rig, const Pose& world_from_body) {
  return inverse(world_from_body * rig.body_from_camera);
}

}  // namespace byre
