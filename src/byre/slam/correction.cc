#include "byre/alignment.h"
#include "byre/geometry/median.h"
#include "byre/slam/global_mapping.h"

#include <algorithm>
#include <cstdint>
#include <map>
#include <optional>
#include <vector>

namespace byre {
namespace {

// A copy's points are ascending, and so are those that its difference to another names.
const WindowPoint* find_point(const MapWindow& window, PointId id) {
  const auto found =
      std::ranges::lower_bound(window.points, id, {}, [](const WindowPoint& point) { return *point.id; });
  return found != window.points.end() && *found->id == id ? &*found : nullptr;
}

using Positions = std::map<PointId, Eigen::Vector3d>;

Positions positions_of(const MapWindow& window) {
  Positions positions;
  for (const WindowPoint& point : window.points) {
    if (point.id) positions[*point.id] = point.point.position_in_world;
  }
  return positions;
}

// Positions of the points that the correction leaves.
Positions positions_after(const MapDelta& correction, const MapWindow& before) {
  Positions positions = positions_of(before);
  for (const UpdatedPoint& updated : correction.updated_points) positions[updated.id] = updated.point.position_in_world;
  for (const OnlinePointId removed : correction.removed_points) positions.erase(removed);
  return positions;
}

// By what the depths that a keyframe sees have grown; empty where too few points tell.
std::optional<double> growth_of_depths(const MapWindow& before, const WindowKeyframe& keyframe, const Pose& after,
                                       const Positions& positions) {
  constexpr std::size_t kMinPoints = 10;
  std::vector<double> ratios;
  for (const int index : keyframe.point_of_feature) {
    if (index < 0) continue;
    const WindowPoint& point = before.points[static_cast<std::size_t>(index)];
    const auto position = point.id ? positions.find(*point.id) : positions.end();
    if (position == positions.end()) continue;
    const double then = (keyframe.keyframe.camera_from_world * point.point.position_in_world).z();
    const double now = (after * position->second).z();
    if (then > 0.0 && now > 0.0) ratios.push_back(now / then);
  }
  if (ratios.size() < kMinPoints) return std::nullopt;
  return median(std::move(ratios));
}

// How the world around each keyframe moves, world_after_from_world_before, for those of the copy that was corrected:
// the keyframe's own motion, and as much longer as what it sees became farther away.
class WorldMotion {
 public:
  WorldMotion(const MapDelta& correction, const MapWindow& before, const Map& map) : map_(map) {
    const bool may_grow = scale_may_drift(before);
    const Positions positions = may_grow ? positions_after(correction, before) : Positions{};
    std::map<KeyframeId, const WindowKeyframe*> keyframes_before;
    for (const WindowKeyframe& keyframe : before.keyframes) {
      newest_ = std::max(newest_, keyframe.id.number);
      motions_[keyframe.id] = Similarity{};
      keyframes_before[keyframe.id] = &keyframe;
    }
    for (const MovedKeyframe& moved : correction.moved_keyframes) {
      const WindowKeyframe& keyframe = *keyframes_before.at(moved.id);
      std::optional<double> growth = 1.0;
      if (may_grow) growth = growth_of_depths(before, keyframe, moved.camera_from_world, positions);
      if (!growth) growth = of(keyframe.keyframe.parent).scale;
      motions_[moved.id] = {
          *growth, inverse(moved.camera_from_world) * scale_lengths(keyframe.keyframe.camera_from_world, *growth)};
    }
  }

  // A keyframe that was there when the copy was made and is not in it stays where it is.
  bool is_left_out(KeyframeId id) const { return id.number <= newest_ && !motions_.contains(id); }

  // Motion about a keyframe; for one that came later, that of its nearest ancestor. Parents are older, so this ends.
  Similarity of(std::optional<KeyframeId> id) const {
    while (id) {
      const auto known = motions_.find(*id);
      if (known != motions_.end()) return known->second;
      if (is_left_out(*id)) return {};
      const Keyframe* const keyframe = map_.find_keyframe(*id);
      id = keyframe != nullptr ? keyframe->parent : std::nullopt;
    }
    return {};
  }

 private:
  const Map& map_;
  std::map<KeyframeId, Similarity> motions_;
  std::uint32_t newest_ = 0;  // number of the newest keyframe of the copy
};

struct PlacedPoint {
  PointId id;
  MapPoint point;
};

MapPoint carried_along(const Similarity& world_motion, const MapPoint& point) {
  MapPoint carried = point;
  carried.position_in_world = world_motion * point.position_in_world;
  carried.covariance *= world_motion.scale * world_motion.scale;
  carried.mean_viewing_direction =
      world_motion.target_from_source.rotation.cast<float>() * point.mean_viewing_direction;
  carried.min_distance *= static_cast<float>(world_motion.scale);
  carried.max_distance *= static_cast<float>(world_motion.scale);
  return carried;
}

// Points that the correction does not place itself, as they lie after it: those made or moved since the copy was taken.
std::vector<PlacedPoint> carried_points(const MapDelta& correction, const MapWindow& before, const WorldMotion& motion,
                                        const Map& map) {
  std::vector<PlacedPoint> carried;
  for (const PointId id : map.point_ids()) {
    const MapPoint& now = *map.find_point(id);
    const WindowPoint* const then = find_point(before, id);
    if (then == nullptr && motion.is_left_out(now.reference.keyframe)) continue;
    const bool as_it_was = then != nullptr && then->point.position_in_world == now.position_in_world;
    const auto number_of = [](const UpdatedPoint& updated) { return updated.id.number; };
    if (as_it_was && std::ranges::binary_search(correction.updated_points, id.number, {}, number_of)) continue;
    carried.push_back({id, carried_along(motion.of(now.reference.keyframe), now)});
  }
  return carried;
}

std::vector<MovedKeyframe> carried_keyframes(const WorldMotion& motion, const Map& map) {
  std::vector<MovedKeyframe> carried;
  for (const KeyframeId id : map.keyframe_ids()) {
    if (motion.is_left_out(id)) continue;
    const Keyframe& keyframe = *map.find_keyframe(id);
    const Similarity world_motion = motion.of(id);
    carried.push_back({{id.number},
                       move_camera(world_motion, keyframe.camera_from_world),
                       scale_lengths(keyframe.covariance, world_motion.scale)});
  }
  return carried;
}

// Changes of length at all keyframes the map ever had.
LengthChanges length_changes(const WorldMotion& motion, const Map& map) {
  LengthChanges changes;
  for (KeyframeId id{map.origin(), 0};; ++id.number) {
    const std::optional<KeyframeId> living = map.living_ancestor(id);
    if (!living) return changes;
    const double growth = motion.of(living).scale;
    if (growth != 1.0) changes[id] = growth;
  }
}

}  // namespace

LengthChanges apply_correction(const MapDelta& correction, const MapWindow& before, Map& online) {
  const WorldMotion motion(correction, before, online);
  const std::vector<PlacedPoint> points = carried_points(correction, before, motion, online);
  const LengthChanges changes = length_changes(motion, online);
  MapDelta applied = correction;
  applied.moved_keyframes = carried_keyframes(motion, online);
  apply(applied, online);
  for (const auto& [id, growth] : changes) online.scale_removed_keyframe(id, growth);
  for (const PlacedPoint& placed : points) {
    MapPoint point = placed.point;
    const MapPoint* const now = online.find_point(placed.id);
    if (now == nullptr) continue;
    point.reference = now->reference;  // it may have lost its own
    online.update_point(placed.id, point);
  }
  return changes;
}

LoopEdge in_new_lengths(const LoopEdge& loop, const LengthChanges& changes) {
  const auto growth_at = [&](KeyframeId id) {
    const auto change = changes.find(id);
    return change == changes.end() ? 1.0 : change->second;
  };
  const double growth = growth_at(loop.keyframe);
  LoopEdge now = loop;
  now.keyframe_from_place = scale_lengths(loop.keyframe_from_place, growth);
  now.covariance = scale_lengths(loop.covariance, growth);
  now.scale = loop.scale * growth / growth_at(loop.place);
  return now;
}

}  // namespace byre
