#include "byre/slam/loops/recent_map.h"

#include <set>

namespace byre {
namespace {

constexpr int kMinSharedWithNew = 30;  // points shared with a new keyframe by a keyframe that moves as well
constexpr int kAroundLoopEnd = 15;     // keyframes around the end of a loop that move as well

using Keyframes = std::set<KeyframeId>;

Keyframes movable_keyframes(const MapGraph& map, std::uint32_t first_new, const std::vector<LoopEdge>& loops) {
  Keyframes movable;
  for (const KeyframeId id : map.keyframe_ids()) {
    if (id.number < first_new) continue;
    movable.insert(id);
    for (const Covisible& other : map.covisible_keyframes(id)) {
      if (other.shared_points < kMinSharedWithNew) break;
      movable.insert(other.keyframe);
    }
  }
  for (const LoopEdge& loop : loops) {
    for (const KeyframeId end : {loop.place, loop.keyframe}) {
      if (map.find_keyframe(end) == nullptr) continue;
      movable.insert(end);
      for (const Covisible& other : map.covisible_keyframes(end, kAroundLoopEnd)) movable.insert(other.keyframe);
    }
  }
  return movable;
}

Keyframes keyframes_around(const MapGraph& map, const Keyframes& movable) {
  Keyframes around;
  for (const KeyframeId id : movable) {
    for (const Covisible& other : map.covisible_keyframes(id)) {
      if (!movable.contains(other.keyframe)) around.insert(other.keyframe);
    }
  }
  return around;
}

}  // namespace

MapWindow recent_map(const MapView& map, std::uint32_t first_new, const std::vector<LoopEdge>& loops) {
  if (first_new == 0) return whole_map(map);
  const Keyframes movable = movable_keyframes(map.online(), first_new, loops);
  const Keyframes around = keyframes_around(map.online(), movable);
  if (2 * (movable.size() + around.size()) > static_cast<std::size_t>(map.online().keyframe_count())) {
    return whole_map(map);
  }
  MapWindow window = window_of(map, {movable.begin(), movable.end()}, {around.begin(), around.end()});
  for (WindowKeyframe& keyframe : window.keyframes) keyframe.movable = movable.contains(keyframe.id);
  fix_gauge(window, WindowOptions{}.min_offline_sightings);
  return window;
}

double disagreement(const MapGraph& map, const LoopEdge& loop) {
  const Keyframe* const keyframe = map.find_keyframe(loop.keyframe);
  const Keyframe* const place = map.find_keyframe(loop.place);
  if (keyframe == nullptr || place == nullptr) return 0.0;
  const Pose now = keyframe->camera_from_world * inverse(place->camera_from_world);
  return (now * inverse(loop.keyframe_from_place)).translation.norm();
}

}  // namespace byre
