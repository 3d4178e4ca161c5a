#include "byre/viewer/scene.h"

namespace byre {
namespace {

void append(const MapGraph& map, MapScene& scene) {
  for (const PointId id : map.point_ids()) {
    scene.points.push_back({map.find_point(id)->position_in_world.cast<float>(), id.origin});
  }
  for (const KeyframeId id : map.keyframe_ids()) {
    const Keyframe& keyframe = *map.keyframe_header(id);
    const Rig& rig = map.rigs()[static_cast<std::size_t>(keyframe.rig)];
    scene.keyframes.push_back(
        {keyframe.frame.time, inverse(rig.body_from_camera * keyframe.camera_from_world), id.origin});
  }
}

}  // namespace

MapScene scene_of(const MapView& map) {
  MapScene scene;
  if (map.offline() != nullptr) append(*map.offline(), scene);
  append(map.online(), scene);
  return scene;
}

}  // namespace byre
