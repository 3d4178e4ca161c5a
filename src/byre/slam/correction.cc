#include "byre/slam/global_mapping.h"

#include <map>
#include <optional>
#include <vector>

namespace byre {
namespace {

// How the world around each keyframe moves: world_after_from_world_before, for those of the copy that was corrected.
class WorldMotion {
 public:
  WorldMotion(const MapDelta& correction, const MapWindow& before, const Map& map) : map_(map) {
    for (const WindowKeyframe& keyframe : before.keyframes) motions_[keyframe.id] = Pose{};
    std::map<KeyframeId, Pose> poses_before;
    for (const WindowKeyframe& keyframe : before.keyframes) {
      poses_before[keyframe.id] = keyframe.keyframe.camera_from_world;
    }
    for (const MovedKeyframe& moved : correction.moved_keyframes) {
      motions_[moved.id] = inverse(moved.camera_from_world) * poses_before.at(moved.id);
    }
  }

  // Of a keyframe that came later: that of its nearest ancestor. Parents are older, so this ends.
  Pose of(std::optional<KeyframeId> id) const {
    while (id) {
      const auto known = motions_.find(*id);
      if (known != motions_.end()) return known->second;
      const Keyframe* const keyframe = map_.find_keyframe(*id);
      id = keyframe != nullptr ? keyframe->parent : std::nullopt;
    }
    return {};
  }

 private:
  const Map& map_;
  std::map<KeyframeId, Pose> motions_;
};

std::map<PointId, Eigen::Vector3d> positions_of(const MapWindow& window) {
  std::map<PointId, Eigen::Vector3d> positions;
  for (const WindowPoint& point : window.points) {
    if (point.id) positions[*point.id] = point.point.position_in_world;
  }
  return positions;
}

struct PlacedPoint {
  PointId id;
  MapPoint point;
};

// Points that the correction does not place itself, as they lie after it: those made or moved since the copy was taken.
std::vector<PlacedPoint> carried_points(const MapDelta& correction, const MapWindow& before, const WorldMotion& motion,
                                        const Map& map) {
  const std::map<PointId, Eigen::Vector3d> positions_before = positions_of(before);
  std::map<PointId, const MapPoint*> corrected;
  for (const UpdatedPoint& updated : correction.updated_points) corrected[updated.id] = &updated.point;
  std::vector<PlacedPoint> carried;
  for (const PointId id : map.point_ids()) {
    const MapPoint& now = *map.find_point(id);
    const auto then = positions_before.find(id);
    const bool as_it_was = then != positions_before.end() && then->second == now.position_in_world;
    if (as_it_was && corrected.contains(id)) continue;
    const Pose world_motion = motion.of(now.reference.keyframe);
    MapPoint point = now;
    point.position_in_world = world_motion * now.position_in_world;
    point.mean_viewing_direction = world_motion.rotation.cast<float>() * now.mean_viewing_direction;
    carried.push_back({id, point});
  }
  return carried;
}

std::vector<MovedKeyframe> carried_keyframes(const WorldMotion& motion, const Map& map) {
  std::vector<MovedKeyframe> carried;
  for (const KeyframeId id : map.keyframe_ids()) {
    const Keyframe& keyframe = *map.find_keyframe(id);
    carried.push_back({{id.number}, keyframe.camera_from_world * inverse(motion.of(id)), keyframe.covariance});
  }
  return carried;
}

}  // namespace

void apply_correction(const MapDelta& correction, const MapWindow& before, Map& online) {
  const WorldMotion motion(correction, before, online);
  const std::vector<PlacedPoint> points = carried_points(correction, before, motion, online);
  MapDelta applied = correction;
  applied.moved_keyframes = carried_keyframes(motion, online);
  apply(applied, online);
  for (const PlacedPoint& placed : points) {
    MapPoint point = placed.point;
    const MapPoint* const now = online.find_point(placed.id);
    if (now == nullptr) continue;
    point.reference = now->reference;  // it may have lost its own
    online.update_point(placed.id, point);
  }
}

}  // namespace byre
