#include "byre/map/map_graph.h"
#include "byre/map/map_values.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <set>

namespace byre {
namespace {

using Faults = std::vector<std::string>;

std::string name_of(Origin origin, std::uint32_t number) {
  return (origin == Origin::offline ? "offline " : "online ") + std::to_string(number);
}
std::string name_of(KeyframeId id) {
  return "keyframe " + name_of(id.origin, id.number);
}
std::string name_of(PointId id) {
  return "point " + name_of(id.origin, id.number);
}

bool is_sound(const Pose& pose) {
  constexpr double kTolerance = 1e-6;
  return pose.translation.allFinite() && std::abs(pose.rotation.norm() - 1.0) < kTolerance;
}

bool is_observed(const MapGraph& map, PointId point, const Observation& observation) {
  return std::ranges::binary_search(map.observations(point), observation);
}

// If every parent precedes its child, the parents form trees.
bool is_parent_sound(const MapGraph& map, KeyframeId id, const Keyframe& keyframe) {
  return !keyframe.parent || (*keyframe.parent < id && map.find_keyframe(*keyframe.parent));
}

void check_sightings(const MapGraph& map, KeyframeId id, const Keyframe& keyframe, Faults& faults) {
  const std::size_t feature_count = keyframe.frame.features ? keyframe.frame.features->keypoints().size() : 0;
  if (keyframe.sightings.size() != feature_count)
    faults.push_back(name_of(id) + " does not have one sighting per feature");
  for (std::size_t i = 0; i < keyframe.sightings.size(); ++i) {
    const std::optional<PointId> point = keyframe.sightings[i].point;
    if (!point) continue;
    if (point->origin == map.origin() && !map.find_point(*point)) {
      faults.push_back(name_of(id) + " observes the removed " + name_of(*point));
    } else if (!is_observed(map, *point, {id, static_cast<int>(i)})) {
      faults.push_back(name_of(id) + " observes " + name_of(*point) + ", which does not list the observation");
    }
  }
}

void check_keyframe(const MapGraph& map, KeyframeId id, Faults& faults) {
  const Keyframe& keyframe = *map.find_keyframe(id);
  if (keyframe.rig < 0 || static_cast<std::size_t>(keyframe.rig) >= map.rigs().size()) {
    faults.push_back(name_of(id) + " has no rig");
  }
  if (!is_sound(keyframe.camera_from_world)) faults.push_back(name_of(id) + " has an invalid pose");
  if (!is_parent_sound(map, id, keyframe)) faults.push_back(name_of(id) + " has a removed or younger parent");
  check_sightings(map, id, keyframe, faults);
}

// Checks both ends of every observation of a point of this map or of an offline one.
void check_observations(const MapGraph& map, PointId id, Faults& faults) {
  const std::vector<Observation>& observations = map.observations(id);
  const auto by_keyframe = [](const Observation& a, const Observation& b) { return a.keyframe >= b.keyframe; };
  if (std::ranges::adjacent_find(observations, by_keyframe) != observations.end()) {
    faults.push_back(name_of(id) + " has unsorted or duplicate observations");
  }
  for (const auto& [keyframe_id, feature] : observations) {
    const Keyframe* keyframe = map.find_keyframe(keyframe_id);
    if (!keyframe || keyframe->sightings.at(static_cast<std::size_t>(feature)).point != id) {
      faults.push_back(name_of(id) + " lists an observation by " + name_of(keyframe_id) +
                       ", which does not observe it");
    }
  }
}

void check_foreign_views(const MapGraph& map, PointId id, Faults& faults) {
  const std::vector<ForeignView>& views = map.foreign_views(id);
  const auto by_keyframe = [](const ForeignView& a, const ForeignView& b) {
    return a.observation.keyframe >= b.observation.keyframe;
  };
  if (std::ranges::adjacent_find(views, by_keyframe) != views.end()) {
    faults.push_back(name_of(id) + " has unsorted or duplicate foreign views");
  }
  for (const auto& [observation, sighting] : views) {
    const std::string view = name_of(id) + "'s view by " + name_of(observation.keyframe);
    if (observation.keyframe.origin == map.origin()) faults.push_back(view + " is not foreign");
    if (sighting.point != id || map.point_of_foreign_view(observation) != id) {
      faults.push_back(view + " also belongs to another point");
    }
    if (const auto fault = fault_in(sighting); !fault.empty()) faults.push_back(view + " " + std::string(fault));
  }
}

void check_point(const MapGraph& map, PointId id, Faults& faults) {
  const MapPoint& point = *map.find_point(id);
  if (map.observations(id).empty()) faults.push_back(name_of(id) + " is not observed by any keyframe");
  if (!is_observed(map, id, point.reference))
    faults.push_back(name_of(id) + " has a reference keyframe that does not observe it");
  if (!point.position_in_world.allFinite()) faults.push_back(name_of(id) + " has no finite position");
  if (!is_unit(point.mean_viewing_direction))
    faults.push_back(name_of(id) + " has a viewing direction that is not of unit length");
  if (!(point.min_distance >= 0.0f && point.min_distance <= point.max_distance)) {
    faults.push_back(name_of(id) + " has an invalid distance range");
  }
  check_observations(map, id, faults);
  check_foreign_views(map, id, faults);
}

std::set<PointId> points_seen_from(const MapGraph& map, KeyframeId id) {
  std::set<PointId> points;
  for (const Sighting& sighting : map.find_keyframe(id)->sightings) {
    if (sighting.point) points.insert(*sighting.point);
  }
  return points;
}

void check_covisibility(const MapGraph& map, KeyframeId id, Faults& faults) {
  std::map<KeyframeId, int> counted;
  for (const PointId point : points_seen_from(map, id)) {
    for (const Observation& observation : map.observations(point)) ++counted[observation.keyframe];
  }
  counted.erase(id);
  std::map<KeyframeId, int> maintained;
  for (const auto& [keyframe, shared] : map.covisible_keyframes(id, std::numeric_limits<int>::max())) {
    maintained.emplace(keyframe, shared);
  }
  if (counted != maintained) faults.push_back(name_of(id) + " has wrong counts of covisible keyframes");
}

std::set<PointId> foreign_points(const MapGraph& map) {
  std::set<PointId> foreign;
  for (const KeyframeId id : map.keyframe_ids()) {
    for (const PointId point : points_seen_from(map, id)) {
      if (point.origin != map.origin()) foreign.insert(point);
    }
  }
  return foreign;
}

}  // namespace

std::vector<std::string> find_faults(const MapGraph& map) {
  Faults faults;
  const std::vector<KeyframeId> keyframes = map.keyframe_ids();
  const std::vector<PointId> points = map.point_ids();
  if (map.keyframe_count() != static_cast<int>(keyframes.size())) faults.push_back("the keyframe count is wrong");
  if (map.point_count() != static_cast<int>(points.size())) faults.push_back("the point count is wrong");
  for (const KeyframeId id : keyframes) {
    check_keyframe(map, id, faults);
    check_covisibility(map, id, faults);
  }
  for (const PointId id : points) check_point(map, id, faults);
  for (const PointId id : foreign_points(map)) check_observations(map, id, faults);
  return faults;
}

}  // namespace byre
