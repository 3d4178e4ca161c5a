#include "byre/slam/upkeep/session_summary.h"

#include <algorithm>
#include <vector>

namespace byre {
namespace {

// Metres plus radians.
double distance_between(const Pose& one, const Pose& other) {
  const Pose change = one * inverse(other);
  return change.translation.norm() + rotation_log(change.rotation).norm();
}

// Ascending; the first one of keyframes that are close together.
std::vector<KeyframeId> separate_keyframes(const MapGraph& map, double spacing) {
  std::vector<KeyframeId> kept;
  for (const KeyframeId id : map.keyframe_ids()) {
    const Pose& pose = map.find_keyframe(id)->camera_from_world;
    const auto is_near = [&](KeyframeId other) {
      return distance_between(pose, map.find_keyframe(other)->camera_from_world) < spacing;
    };
    if (std::ranges::none_of(kept, is_near)) kept.push_back(id);
  }
  return kept;
}

}  // namespace

void thin_out(MapGraph& online, int max_keyframes) {
  constexpr double kSpacing = 0.3;
  constexpr double kGrowth = 1.3;
  constexpr std::size_t kViews = 2;
  std::vector<KeyframeId> kept = separate_keyframes(online, kSpacing);
  for (double spacing = kSpacing; static_cast<int>(kept.size()) > max_keyframes; spacing *= kGrowth) {
    kept = separate_keyframes(online, spacing);
  }
  for (const KeyframeId id : online.keyframe_ids()) {
    if (!std::ranges::binary_search(kept, id)) online.remove_keyframe(id);
  }
  for (const PointId id : online.point_ids()) {
    if (online.observations(id).size() < kViews) online.remove_point(id);
  }
}

}  // namespace byre
