#include "byre/slam/window/registration.h"

#include "byre/map/scaled_copy.h"

#include <map>

namespace byre {
namespace {

struct PathKeyframe {
  OnlineKeyframeId id;
  Pose camera_from_world;
  double travelled = 0.0;  // metres since the first
};

std::vector<PathKeyframe> measured_path(const MapGraph& online, const std::vector<KeyframeId>& keyframes) {
  std::vector<PathKeyframe> path;
  for (const KeyframeId id : keyframes) {
    PathKeyframe entry{{id.number}, online.find_keyframe(id)->camera_from_world};
    if (!path.empty()) {
      const Eigen::Vector3d before = inverse(path.back().camera_from_world).translation;
      const Eigen::Vector3d here = inverse(entry.camera_from_world).translation;
      entry.travelled = path.back().travelled + (here - before).norm();
    }
    path.push_back(entry);
  }
  return path;
}

// Share of a rigid motion that rotates about a pivot; the pivot moves by that share of its motion.
Pose share_of(const Pose& motion, double share, const Eigen::Vector3d& pivot) {
  const Eigen::Vector3d shift = share * (motion * pivot - pivot);
  const Eigen::Quaterniond turn = rotation_exp(share * rotation_log(motion.rotation));
  return {turn, pivot + shift - turn * pivot};
}

void append_points(const MapGraph& online, const std::map<KeyframeId, Pose>& motions, MapDelta& delta) {
  for (const PointId id : online.point_ids()) {
    const MapPoint& point = *online.find_point(id);
    const auto motion = motions.find(point.reference.keyframe);
    if (motion == motions.end()) continue;
    delta.updated_points.push_back({{id.number}, moved(point, motion->second)});
  }
}

// Observations that were made at a refuted place. They would draw the keyframes back there.
void remove_links_to_offline(const MapGraph& online, const std::map<KeyframeId, Pose>& motions, MapDelta& delta) {
  for (const auto& [id, motion] : motions) {
    const std::vector<Sighting>& sightings = online.find_keyframe(id)->sightings;
    for (std::size_t i = 0; i < sightings.size(); ++i) {
      const OptionalPoint& point = sightings[i].point;
      if (!point || point->origin != Origin::offline) continue;
      delta.removed_observations.push_back({{id.number}, static_cast<int>(i), *point});
    }
  }
  for (const UpdatedPoint& moved : delta.updated_points) {
    for (const ForeignView& view : online.foreign_views(moved.id)) {
      delta.removed_foreign_views.push_back({moved.id, view.observation});
    }
  }
}

}  // namespace

MapDelta correction_of(const MapGraph& online, const std::vector<KeyframeId>& path, const Pose& offline_from_online,
                       CorrectionShape shape) {
  MapDelta delta;
  const std::vector<PathKeyframe> measured = measured_path(online, path);
  if (measured.empty()) return delta;
  const Eigen::Vector3d pivot = inverse(measured.back().camera_from_world).translation;
  const double length = measured.back().travelled;
  std::map<KeyframeId, Pose> motions;
  for (const PathKeyframe& keyframe : measured) {
    const bool whole = shape == CorrectionShape::rigid || length <= 0.0;
    const Pose motion = whole ? offline_from_online : share_of(offline_from_online, keyframe.travelled / length, pivot);
    motions[keyframe.id] = motion;
    const Matrix6& covariance = online.find_keyframe(keyframe.id)->covariance;
    delta.moved_keyframes.push_back({keyframe.id, keyframe.camera_from_world * inverse(motion), covariance});
  }
  append_points(online, motions, delta);
  if (shape == CorrectionShape::rigid) remove_links_to_offline(online, motions, delta);
  return delta;
}

}  // namespace byre
