#include "byre/map/keyframe_path.h"

#include <algorithm>

namespace byre {

Pose world_from_body(const MapGraph& map, const Keyframe& keyframe) {
  const Rig& rig = map.rigs()[static_cast<std::size_t>(keyframe.rig)];
  return inverse(rig.body_from_camera * keyframe.camera_from_world);
}

Trajectory keyframe_path(const MapGraph& map) {
  Trajectory path;
  for (const KeyframeId id : map.keyframe_ids()) {
    const Keyframe& keyframe = *map.keyframe_header(id);
    path.push_back({keyframe.frame.time, world_from_body(map, keyframe)});
  }
  std::ranges::stable_sort(path, {}, &StampedPose::time);
  const auto is_same_time = [](const StampedPose& a, const StampedPose& b) { return a.time == b.time; };
  const auto repeated = std::unique(path.begin(), path.end(), is_same_time);
  path.erase(repeated, path.end());
  return path;
}

}  // namespace byre
