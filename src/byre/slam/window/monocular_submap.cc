#include "byre/slam/window/monocular_submap.h"

#include "byre/alignment.h"

#include <cmath>
#include <utility>

namespace byre {
namespace {

// Similarity from the start's world to the map's.
struct Placement {
  Pose world_from_start;
  double scale = 1.0;

  Pose moved(const Pose& camera_from_start) const {
    return scale_lengths(camera_from_start, scale) * inverse(world_from_start);
  }
};

// Empty if the cameras moved differently than measured.
std::optional<Placement> placement_of(const MonocularStart& start, const StartPoses& odometry) {
  constexpr double kMaxTurn = 0.1;        // radians between visual and measured turn
  constexpr double kMaxDirection = 0.35;  // radians between the directions of motion
  const Pose first_from_start = start.map.camera_from_world(start.first);
  const Pose seen = first_from_start * inverse(start.map.camera_from_world(start.second));
  const Pose motion = odometry.first_camera_from_world * inverse(odometry.second_camera_from_world);
  const double odometry_length = motion.translation.norm(), seen_length = seen.translation.norm();
  if (!(odometry_length > 0.0) || !(seen_length > 0.0)) return {};
  const double cosine = motion.translation.dot(seen.translation) / (odometry_length * seen_length);
  if (angle_between(motion.rotation, seen.rotation) > kMaxTurn || cosine < std::cos(kMaxDirection)) return {};
  const double scale = odometry_length / seen_length;
  return Placement{inverse(odometry.first_camera_from_world) * scale_lengths(first_from_start, scale), scale};
}

double distance_between(const Pose& first_from_world, const Pose& second_from_world) {
  return (first_from_world * inverse(second_from_world)).translation.norm();
}

// Scale of the start by the measured motion; empty if that does not determine it.
std::optional<double> odometry_scale(const MonocularStart& start, const StartPoses& odometry) {
  constexpr double kLeastWay = 0.05;   // metres
  constexpr double kUsualArm = 0.3;    // metres
  constexpr double kMostByArm = 0.25;  // share of the motion
  const Pose &first = odometry.first_camera_from_world, &second = odometry.second_camera_from_world;
  const double motion = distance_between(first, second), turn = angle_between(first.rotation, second.rotation);
  const double seen =
      distance_between(start.map.camera_from_world(start.first), start.map.camera_from_world(start.second));
  if (motion < kLeastWay || kUsualArm * turn > kMostByArm * motion || !(seen > 0.0)) return {};
  return motion / seen;
}

KeyframeId add_keyframe(const MonocularStart& start, KeyframeId id, const Placement& placement,
                        const std::optional<KeyframeId>& parent, int recording, Map& map) {
  Keyframe keyframe = *start.map.find_keyframe(id);
  keyframe.rig = map.add_rig(start.map.rigs()[static_cast<std::size_t>(keyframe.rig)]);
  keyframe.recording = recording;
  keyframe.camera_from_world = placement.moved(keyframe.camera_from_world);
  keyframe.covariance = scale_lengths(keyframe.covariance, placement.scale);
  keyframe.sightings.clear();
  keyframe.words.clear();
  keyframe.parent = parent;
  return map.add_keyframe(std::move(keyframe));
}

MapPoint moved(const MapPoint& point, const Placement& placement) {
  const Eigen::Matrix3d rotation = placement.world_from_start.rotation.toRotationMatrix();
  const auto scale = static_cast<float>(placement.scale);
  MapPoint result = point;
  result.position_in_world = placement.world_from_start * (placement.scale * point.position_in_world);
  result.covariance = placement.scale * placement.scale * rotation * point.covariance * rotation.transpose();
  result.mean_viewing_direction = rotation.cast<float>() * point.mean_viewing_direction;
  result.min_distance *= scale;
  result.max_distance *= scale;
  return result;
}

// Returns the two keyframes.
std::vector<KeyframeId> add_start(const MonocularStart& start, const Placement& placement,
                                  const std::optional<KeyframeId>& parent, int recording, Map& map) {
  const KeyframeId first = add_keyframe(start, start.first, placement, parent, recording, map);
  const KeyframeId second = add_keyframe(start, start.second, placement, first, recording, map);
  const auto renamed = [&](KeyframeId id) { return id == start.first ? first : second; };
  for (const PointId id : start.map.point_ids()) {
    MapPoint point = moved(*start.map.find_point(id), placement);
    point.reference.keyframe = renamed(point.reference.keyframe);
    const PointId added = map.add_point(point);
    for (const Observation& seen : start.map.observations(id)) {
      Sighting sighting = start.map.find_keyframe(seen.keyframe)->sightings[static_cast<std::size_t>(seen.feature)];
      sighting.point = added;
      map.add_observation({renamed(seen.keyframe), seen.feature}, sighting);
    }
  }
  return {first, second};
}

}  // namespace

std::vector<KeyframeId> add_monocular_submap(const MonocularStart& start, const StartPoses& odometry,
                                             const std::optional<KeyframeId>& parent, int recording, Map& map) {
  const auto placement = placement_of(start, odometry);
  return placement ? add_start(start, *placement, parent, recording, map) : std::vector<KeyframeId>{};
}

MonocularStart align_to_odometry(const MonocularStart& start, const StartPoses& odometry) {
  const double scale = odometry_scale(start, odometry).value_or(1.0);
  const Pose second_from_start = scale_lengths(start.map.camera_from_world(start.second), scale);
  MonocularStart result = start;
  result.map = Map(Origin::online);
  const auto keyframes = add_start(start, {inverse(odometry.second_camera_from_world) * second_from_start, scale}, {},
                                   start.map.find_keyframe(start.first)->recording, result.map);
  result.first = keyframes.front();
  result.second = keyframes.back();
  return result;
}

}  // namespace byre
