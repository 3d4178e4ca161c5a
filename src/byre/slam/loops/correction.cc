#include "byre/alignment.h"
#include "byre/geometry/median.h"
#include "byre/slam/loops/global_mapping.h"

#include <algorithm>
#include <cstdint>
#include <map>
#include <optional>
#include <utility>
#include <vector>

namespace byre {
namespace {

// State of a map when the corrected copy was made.
class Earlier {
 public:
  virtual ~Earlier() = default;
  virtual std::vector<KeyframeId> keyframes() const = 0;  // in any order
  virtual const Keyframe& keyframe(KeyframeId id) const = 0;
  virtual std::vector<PointId> points_of(KeyframeId id) const = 0;
  virtual const MapPoint* find_point(PointId id) const = 0;
};

class EarlierWindow : public Earlier {
 public:
  explicit EarlierWindow(const MapWindow& window) : window_(window) {
    for (const WindowKeyframe& keyframe : window.keyframes) keyframes_[keyframe.id] = &keyframe;
  }

  std::vector<KeyframeId> keyframes() const override {
    std::vector<KeyframeId> ids;
    for (const auto& [id, keyframe] : keyframes_) ids.push_back(id);
    return ids;
  }
  const Keyframe& keyframe(KeyframeId id) const override { return keyframes_.at(id)->keyframe; }
  std::vector<PointId> points_of(KeyframeId id) const override {
    std::vector<PointId> points;
    for (const int index : keyframes_.at(id)->point_of_feature) {
      if (index >= 0) points.push_back(*window_.points[static_cast<std::size_t>(index)].id);
    }
    return points;
  }
  const MapPoint* find_point(PointId id) const override {
    const auto found =
        std::ranges::lower_bound(window_.points, id, {}, [](const WindowPoint& point) { return *point.id; });
    return found != window_.points.end() && *found->id == id ? &found->point : nullptr;
  }

 private:
  const MapWindow& window_;
  std::map<KeyframeId, const WindowKeyframe*> keyframes_;
};

// State of a map that has not changed since these keyframes were copied.
class EarlierMap : public Earlier {
 public:
  EarlierMap(const MapGraph& map, const MapWindow& copy) : map_(map) {
    for (const WindowKeyframe& keyframe : copy.keyframes) keyframes_.push_back(keyframe.id);
  }

  std::vector<KeyframeId> keyframes() const override { return keyframes_; }
  const Keyframe& keyframe(KeyframeId id) const override { return *map_.find_keyframe(id); }
  std::vector<PointId> points_of(KeyframeId id) const override {
    std::vector<PointId> points;
    for (const Sighting& sighting : map_.find_keyframe(id)->sightings) {
      if (sighting.point) points.push_back(*sighting.point);
    }
    return points;
  }
  const MapPoint* find_point(PointId id) const override { return map_.find_point(id); }

 private:
  const MapGraph& map_;
  std::vector<KeyframeId> keyframes_;
};

// The corrected point; nullptr if it is unchanged. A difference lists points in ascending order.
const MapPoint* corrected_point(const MapDelta& correction, PointId id) {
  const auto number_of = [](const UpdatedPoint& updated) { return updated.id.number; };
  const auto found = std::ranges::lower_bound(correction.updated_points, id.number, {}, number_of);
  return found != correction.updated_points.end() && PointId(found->id) == id ? &found->point : nullptr;
}

bool is_removed(const MapDelta& correction, PointId id) {
  return id.origin == Origin::online &&
         std::ranges::binary_search(correction.removed_points, id.number, {}, &OnlinePointId::number);
}

// Growth of the depths that a keyframe sees; empty with too few points.
std::optional<double> growth_of_depths(const MapDelta& correction, const Earlier& before, KeyframeId id,
                                       const Pose& after) {
  constexpr std::size_t kMinPoints = 10;
  std::vector<double> ratios;
  for (const PointId point_id : before.points_of(id)) {
    const MapPoint* const earlier = before.find_point(point_id);
    if (earlier == nullptr || is_removed(correction, point_id)) continue;
    const MapPoint* const corrected = corrected_point(correction, point_id);
    const double then = (before.keyframe(id).camera_from_world * earlier->position_in_world).z();
    const double now = (after * (corrected ? corrected : earlier)->position_in_world).z();
    if (then > 0.0 && now > 0.0) ratios.push_back(now / then);
  }
  if (ratios.size() < kMinPoints) return std::nullopt;
  return median(std::move(ratios));
}

// Motion of the world around each keyframe of the corrected copy, world_after_from_world_before: the keyframe's motion,
// scaled by the growth of the depths that it sees.
class WorldMotion {
 public:
  WorldMotion(const MapDelta& correction, const Earlier& before, bool may_grow, const MapGraph& map) : map_(map) {
    for (const KeyframeId id : before.keyframes()) {
      newest_ = std::max(newest_, id.number);
      motions_[id] = Similarity{};
    }
    for (const MovedKeyframe& moved : correction.moved_keyframes) {
      const Keyframe& keyframe = before.keyframe(moved.id);
      std::optional<double> growth = 1.0;
      if (may_grow) growth = growth_of_depths(correction, before, moved.id, moved.camera_from_world);
      if (!growth) growth = of(keyframe.parent).scale;
      motions_[moved.id] = {*growth,
                            inverse(moved.camera_from_world) * scale_lengths(keyframe.camera_from_world, *growth)};
    }
  }

  // An earlier keyframe that is not in the copy does not move.
  bool is_left_out(KeyframeId id) const { return id.number <= newest_ && !motions_.contains(id); }

  // Motion around a keyframe; for a later one, that of its nearest ancestor. Parents are older, so the loop ends.
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
  const MapGraph& map_;
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

// Points that the correction does not place, at their positions after it: added or moved since the copy.
std::vector<PlacedPoint> carried_points(const MapDelta& correction, const Earlier& before, const WorldMotion& motion,
                                        const MapGraph& map) {
  std::vector<PlacedPoint> carried;
  for (const PointId id : map.point_ids()) {
    const MapPoint& now = *map.find_point(id);
    const bool is_corrected = corrected_point(correction, id) != nullptr;
    if (!is_corrected && motion.is_left_out(now.reference.keyframe)) continue;
    const MapPoint* const then = is_corrected ? before.find_point(id) : nullptr;
    if (then != nullptr && then->position_in_world == now.position_in_world) continue;
    carried.push_back({id, carried_along(motion.of(now.reference.keyframe), now)});
  }
  return carried;
}

// has_new_covariances: keyframes that the correction moved have its covariance.
std::vector<MovedKeyframe> carried_keyframes(const MapDelta& correction, bool has_new_covariances,
                                             const WorldMotion& motion, const MapGraph& map) {
  std::map<KeyframeId, const Matrix6*> found;
  for (const MovedKeyframe& moved : correction.moved_keyframes) {
    if (has_new_covariances) found[moved.id] = &moved.covariance;
  }
  std::vector<MovedKeyframe> carried;
  for (const KeyframeId id : map.keyframe_ids()) {
    if (motion.is_left_out(id)) continue;
    const Keyframe& keyframe = *map.find_keyframe(id);
    const Similarity world_motion = motion.of(id);
    const auto of_correction = found.find(id);
    carried.push_back({{id.number},
                       move_camera(world_motion, keyframe.camera_from_world),
                       of_correction != found.end() ? *of_correction->second
                                                    : scale_lengths(keyframe.covariance, world_motion.scale)});
  }
  return carried;
}

// Scale changes at all keyframes that the map ever had.
LengthChanges length_changes(const WorldMotion& motion, const MapGraph& map) {
  LengthChanges changes;
  for (KeyframeId id{map.origin(), 0};; ++id.number) {
    const std::optional<KeyframeId> living = map.living_ancestor(id);
    if (!living) return changes;
    const double growth = motion.of(living).scale;
    if (growth != 1.0) changes[id] = growth;
  }
}

// Whether images leave the lengths of a window free, even where measured motion constrains them.
bool may_grow(const MapWindow& window) {
  const auto is_stereo = [&](const WindowKeyframe& keyframe) { return window.rig_of(keyframe).is_stereo(); };
  const auto is_of_offline_map = [](const auto& entry) { return is_offline(entry); };
  return std::ranges::none_of(window.keyframes, is_stereo) && std::ranges::none_of(window.keyframes, is_of_offline_map);
}

LengthChanges apply_since(MapDelta correction, const Earlier& before, bool may_grow, bool has_new_covariances,
                          MapGraph& online) {
  const WorldMotion motion(correction, before, may_grow, online);
  const std::vector<PlacedPoint> points = carried_points(correction, before, motion, online);
  const LengthChanges changes = length_changes(motion, online);
  correction.moved_keyframes = carried_keyframes(correction, has_new_covariances, motion, online);
  apply(correction, online);
  for (const auto& [id, growth] : changes) online.scale_removed_keyframe(id, growth);
  for (const PlacedPoint& placed : points) {
    MapPoint point = placed.point;
    const MapPoint* const now = online.find_point(placed.id);
    if (now == nullptr) continue;
    point.reference = now->reference;  // the reference may have changed since
    online.update_point(placed.id, point);
  }
  return changes;
}

}  // namespace

LengthChanges apply_correction(const MapDelta& correction, const MapWindow& before, MapGraph& online) {
  return apply_since(correction, EarlierWindow(before), may_grow(before), scale_may_drift(before), online);
}

LengthChanges adjust_at_once(MapWindow window, const std::vector<LoopEdge>& loops, const GlobalMappingOptions& options,
                             MapGraph& online, const std::function<bool()>& should_stop) {
  const bool grows = may_grow(window), may_drift = scale_may_drift(window);
  adjust_window(window, loops, options, should_stop);
  MapDelta correction = difference(online, window);
  const EarlierMap before(online, window);
  window = {};
  return apply_since(std::move(correction), before, grows, may_drift, online);
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
