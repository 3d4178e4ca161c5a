#pragma once

// Map of a body that drove along one lane and back along the other, for tests of the ground under it.

#include "byre/geometry/degrees.h"
#include "byre/map/map_graph.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <numbers>
#include <vector>

namespace byre {

// Body axes x forward, y left, z up; the camera looks forward and 20 degrees down.
inline Rig looking_down() {
  Rig rig{320, 240, 188.0, 158.0, 119.0, 0.11, {}};
  Eigen::Matrix3d level_from_camera;
  level_from_camera << 0, 0, 1, -1, 0, 0, 0, -1, 0;
  rig.body_from_camera = {rotation_exp({0.0, 20.0 * kDegree, 0.0}) * Eigen::Quaterniond(level_from_camera),
                          {0.3, 0.0, 0.9}};
  return rig;
}

// The map frame is rotated about all axes relative to a level frame with z up.
inline const Pose kMapFromLevel{rotation_exp({0.4, -0.7, 1.1}), Eigen::Vector3d::Zero()};

inline MapGraph map_of(const std::vector<Pose>& level_from_body) {
  MapGraph map(Origin::offline);
  map.add_rig(looking_down());
  for (const Pose& body : level_from_body) {
    Keyframe keyframe;
    keyframe.frame.time = std::chrono::seconds(map.keyframe_count());
    const Pose map_from_body = kMapFromLevel * body;
    keyframe.camera_from_world = inverse(map_from_body * looking_down().body_from_camera);
    map.add_keyframe(keyframe);
  }
  return map;
}

// Pose of a body at x, y with heading along x or back. The floor rises with the slope from x = 10 m to 16 m.
inline Pose on_floor(double x, double y, double heading, double slope = 0.0) {
  const double rise = slope * std::clamp(x - 10.0, 0.0, 6.0);
  const bool is_on_ramp = x > 10.0 && x < 16.0;
  const Eigen::Quaterniond tilt = rotation_exp({0.0, is_on_ramp ? -std::atan(slope) : 0.0, 0.0});
  return {tilt * rotation_exp({0.0, 0.0, heading}), {x, y, rise}};
}

// Along one lane and back along the other.
inline std::vector<Pose> driven(double slope = 0.0) {
  std::vector<Pose> path;
  for (int i = 0; i < 120; ++i) {
    const bool is_back = i >= 60;
    path.push_back(
        on_floor(0.5 * (is_back ? 119 - i : i), is_back ? 2.0 : 0.0, is_back ? std::numbers::pi : 0.0, slope));
  }
  return path;
}

}  // namespace byre
