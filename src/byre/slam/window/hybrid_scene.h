#pragma once

// A mission on an offline map for tests of mapping: two visits to the same room.

#include "byre/map/map_graph.h"
#include "byre/map/map_view.h"
#include "byre/slam/tracking/mission_scene.h"
#include "byre/slam/window/mapping.h"

#include <map>

namespace byre {

inline constexpr int kFramesPerKeyframe = 2;

// Landmarks of the offline map: half of all, those with even numbers.
inline bool is_known(int landmark) {
  return landmark % 2 == 0;
}

struct HybridScene {
  SimulatedMission first;   // visit that made the offline map
  SimulatedMission second;  // 10 cm off the first
  MapGraph offline{Origin::offline};
  MapGraph online{Origin::online};  // map of the second visit; every second frame is a keyframe
  std::map<int, PointId> known_points;

  MapView view() const { return {&offline, online}; }
  Pose true_pose(KeyframeId id) const {  // true pose of an online keyframe
    return true_camera_from_world(second, static_cast<std::size_t>(kFramesPerKeyframe) * id.number);
  }
};

inline SimulatedMission visit(std::uint64_t noise_seed, double radius, SimulationOptions options) {
  options.noise_seed = noise_seed;
  return simulate_mission(simulated_rig(), circling_trajectory(40, 10.0, radius, 0.25), options);
}

// Replaces online points of known landmarks by the offline points.
inline void see_offline(HybridScene& scene) {
  for (const PointId id : scene.online.point_ids()) {
    const auto known = scene.known_points.find(true_landmark(scene.second, scene.online, id));
    if (known == scene.known_points.end()) continue;
    const std::vector<Observation> observations = scene.online.observations(id);
    for (const Observation& seen : observations) {
      const Keyframe& keyframe = *scene.online.find_keyframe(seen.keyframe);
      Sighting sighting = keyframe.sightings[static_cast<std::size_t>(seen.feature)];
      sighting.point = known->second;
      scene.online.remove_observation(seen);
      scene.online.add_observation(seen, sighting);
    }
  }
}

// Two true maps. The online map has points of its own for all landmarks. Some features of offline keyframes see no
// point, as in imported maps.
inline HybridScene two_true_maps(const SimulationOptions& options) {
  HybridScene scene;
  scene.first = visit(1, 2.0, options);
  scene.second = visit(2, 1.9, options);
  scene.offline = true_map(scene.first, kFramesPerKeyframe, Origin::offline);
  for (const PointId id : scene.offline.point_ids()) {
    if (!is_known(true_landmark(scene.first, scene.offline, id))) scene.offline.remove_point(id);
  }
  for (const PointId id : scene.offline.point_ids()) {
    scene.known_points[true_landmark(scene.first, scene.offline, id)] = id;
  }
  scene.online = true_map(scene.second, kFramesPerKeyframe, Origin::online);
  return scene;
}

// The online map sees the offline points, and has points of its own for the other landmarks.
inline HybridScene true_hybrid_scene(const SimulationOptions& options) {
  HybridScene scene = two_true_maps(options);
  see_offline(scene);
  return scene;
}

// Moves an online map as a whole.
inline void displace(MapGraph& online, const Pose& displaced_from_world) {
  for (const KeyframeId id : online.keyframe_ids()) {
    const Keyframe& keyframe = *online.find_keyframe(id);
    online.move_keyframe(id, keyframe.camera_from_world * inverse(displaced_from_world), keyframe.covariance);
  }
  for (const PointId id : online.point_ids()) {
    MapPoint point = *online.find_point(id);
    point.position_in_world = displaced_from_world * point.position_in_world;
    online.update_point(id, point);
  }
}

// Maps one keyframe after another, as a session does.
inline void map_in_order(HybridScene& scene, const MappingOptions& options) {
  for (const KeyframeId id : scene.online.keyframe_ids()) {
    const MapWindow window = cut_window(scene.view(), {id}, options.window);
    if (!window.keyframes.empty()) apply(extend_map(window, options), scene.online);
  }
}

}  // namespace byre
