#include "byre/slam/window/mapping.h"

#include "byre/slam/window/mapping_steps.h"

namespace byre {

MapDelta extend_map(const MapWindow& window, const MappingOptions& options) {
  MapWindow extended = window;
  for (int keyframe = 0; keyframe < static_cast<int>(extended.keyframes.size()); ++keyframe) {
    if (!extended.keyframe(keyframe).is_new) continue;
    fuse_duplicates(extended, keyframe, options);
    triangulate_new_points(extended, keyframe, options);
  }
  adjust_bundle(extended, options);
  remove_weak_points(extended, extended.keyframes.front().id, options.hidden);
  refresh_points(extended);
  remove_redundant_keyframes(extended, options);
  return difference(window, extended);
}

}  // namespace byre
