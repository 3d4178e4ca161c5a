#include "byre/slam/upkeep/additions.h"

#include "byre/slam/calibration/calibration_on_map.h"
#include "byre/slam/upkeep/place_budget.h"

#include <algorithm>
#include <iterator>
#include <limits>
#include <map>
#include <optional>
#include <set>
#include <span>
#include <utility>

namespace byre {
namespace {

int sightings_of(const Keyframe& keyframe, std::optional<Origin> origin = {}) {
  return static_cast<int>(std::ranges::count_if(keyframe.sightings, [&](const Sighting& sighting) {
    return sighting.point && (!origin || sighting.point->origin == *origin);
  }));
}

// What a map has near a camera, in a similar viewing direction.
struct KnownPlace {
  int keyframes = 0;
  int points = 0;        // greatest number that one of the keyframes sees
  double nearest = 1e9;  // least distance, metres plus radians between viewing directions
};

KnownPlace known_place(const MapGraph& map, std::span<const KeyframeId> keyframes, const Pose& camera_from_world) {
  KnownPlace place;
  for (const KeyframeId id : keyframes_at(map, keyframes, camera_from_world)) {
    const Keyframe& keyframe = *map.find_keyframe(id);
    const Pose change = camera_from_world * inverse(keyframe.camera_from_world);
    ++place.keyframes;
    place.points = std::max(place.points, sightings_of(keyframe));
    place.nearest = std::min(place.nearest, change.translation.norm() + rotation_log(change.rotation).norm());
  }
  return place;
}

// Variance of a camera's position by the drift from the map: its lengths err by a share since the place where the
// mission left the map, whose own variance is added. Square metres.
double drift_variance(const MapGraph& map, std::span<const KeyframeId> keyframes, const Keyframe& keyframe) {
  const Eigen::Vector3d position = inverse(keyframe.camera_from_world).translation;
  const double share = length_sigma(*keyframe.frame.features);
  double least = std::numeric_limits<double>::infinity();
  for (const KeyframeId id : keyframes) {
    const Keyframe& known = *map.find_keyframe(id);
    const double way = (position - inverse(known.camera_from_world).translation).norm();
    least = std::min(least, position_variance(known.covariance) + share * share * way * way);
  }
  return least;
}

// Keyframes that see the offline map, and those connected with them by common points; ascending.
std::set<KeyframeId> connected_keyframes(const MapGraph& online) {
  constexpr int kThatLocate = 36;  // offline points, see kOfflineThatHolds
  std::set<KeyframeId> connected;
  for (const KeyframeId start : online.keyframe_ids()) {
    if (sightings_of(*online.find_keyframe(start), Origin::offline) < kThatLocate) continue;
    std::vector<KeyframeId> reached = {start};
    while (!reached.empty()) {
      const KeyframeId id = reached.back();
      reached.pop_back();
      if (!connected.insert(id).second) continue;
      for (const Covisible& next : online.covisible_keyframes(id)) reached.push_back(next.keyframe);
    }
  }
  return connected;
}

std::optional<KeyframeId> most_shared(const MapGraph& map, const Keyframe& keyframe) {
  std::map<KeyframeId, int> shared;
  for (const Sighting& sighting : keyframe.sightings) {
    if (!sighting.point) continue;
    for (const Observation& seen : map.observations(*sighting.point)) ++shared[seen.keyframe];
  }
  const auto most = std::ranges::max_element(shared, {}, &std::pair<const KeyframeId, int>::second);
  return most == shared.end() ? std::nullopt : std::optional(most->first);
}

}  // namespace

std::vector<KeyframeId> keyframes_to_add(const MapGraph& map, const MapGraph& child, const MapGraph& online) {
  constexpr double kFew = 0.5;        // known points seen, as a share of those that the map has at this place
  constexpr double kSeparate = 0.4;   // least distance of added keyframes, metres plus radians
  constexpr double kMaxSigma = 0.03;  // metres, of the position
  constexpr int kKeyframesOfPlace = 4;
  const std::vector<KeyframeId> present = map.keyframe_ids();
  std::vector<KeyframeId> others;  // added by other missions
  std::ranges::set_difference(child.keyframe_ids(), present, std::back_inserter(others));
  std::vector<KeyframeId> chosen;
  for (const KeyframeId id : connected_keyframes(online)) {
    const Keyframe& keyframe = *online.find_keyframe(id);
    if (known_place(child, others, keyframe.camera_from_world).keyframes > 0) continue;
    const KnownPlace before = known_place(map, present, keyframe.camera_from_world);
    const KnownPlace added = known_place(online, chosen, keyframe.camera_from_world);
    const bool is_new = before.keyframes == 0;
    const double drift = is_new ? drift_variance(map, present, keyframe) : 0.0;
    if (position_variance(keyframe.covariance) + drift > kMaxSigma * kMaxSigma) continue;
    const bool has_few = sightings_of(keyframe, Origin::offline) < kFew * before.points;
    if (!is_new && !has_few) continue;
    if (added.nearest < kSeparate || added.keyframes >= kKeyframesOfPlace) continue;
    chosen.push_back(id);
  }
  return chosen;
}

Added add_keyframes(const MapGraph& online, const std::vector<KeyframeId>& keyframes, int recording, MapGraph& map) {
  constexpr std::size_t kViews = 3;
  const std::vector<KeyframeId> present = map.keyframe_ids();
  std::map<PointId, PointId> points;  // in the map, by point in the mission
  for (const PointId id : online.point_ids()) {
    const MapPoint& point = *online.find_point(id);
    const bool is_defined = std::ranges::binary_search(keyframes, point.reference.keyframe);
    if (is_defined && online.observations(id).size() >= kViews) points.emplace(id, map.add_point(point));
  }
  std::map<KeyframeId, KeyframeId> added;
  for (const KeyframeId id : keyframes) {
    Keyframe keyframe = *online.find_keyframe(id);
    keyframe.covariance.topLeftCorner<3, 3>().diagonal().array() += drift_variance(map, present, keyframe) / 3.0;
    keyframe.recording = recording;
    keyframe.rig = map.add_rig(online.rigs()[static_cast<std::size_t>(keyframe.rig)]);
    for (Sighting& sighting : keyframe.sightings) {
      if (!sighting.point || sighting.point->origin == Origin::offline) continue;
      const auto point = points.find(*sighting.point);
      sighting.point = point == points.end() ? std::nullopt : std::optional(point->second);
    }
    keyframe.parent = most_shared(map, keyframe);
    added.emplace(id, map.add_keyframe(std::move(keyframe)));
  }
  for (const auto& [before, after] : points) {
    MapPoint point = *online.find_point(before);
    point.reference.keyframe = added.at(point.reference.keyframe);
    map.update_point(after, point);
  }
  return {static_cast<int>(added.size()), static_cast<int>(points.size())};
}

}  // namespace byre
