#include "byre/slam/upkeep/place_budget.h"

#include "byre/slam/upkeep/point_survival.h"

#include <algorithm>
#include <iterator>
#include <optional>
#include <tuple>

namespace byre {
namespace {

// Expected number of points for which a map relies on a keyframe; a point counts for one, shared among its views.
double usefulness(const MapGraph& map, const Keyframe& keyframe, std::span<const Survival> survival) {
  double sum = 0.0;
  for (const Sighting& sighting : keyframe.sightings) {
    if (!sighting.point) continue;
    const auto views = static_cast<double>(map.observations(*sighting.point).size());
    sum += probability_of(survival[sighting.point->number]) / views;
  }
  return sum;
}

// Removes a keyframe, and the points that one other keyframe alone sees: they lose what determined their depth.
void remove(KeyframeId id, MapGraph& map) {
  const std::vector<Sighting> sightings = map.find_keyframe(id)->sightings;
  map.remove_keyframe(id);
  for (const Sighting& sighting : sightings) {
    if (sighting.point && map.observations(*sighting.point).size() < 2) map.remove_point(*sighting.point);
  }
}

struct Place {
  std::vector<KeyframeId> keyframes;
  std::size_t budget = 0;
};

// Places around the keyframes of a map that are over their budget.
std::vector<Place> overfull_places(const MapGraph& parent, int budget, const MapGraph& child) {
  const std::vector<KeyframeId> before = parent.keyframe_ids(), now = child.keyframe_ids();
  std::vector<Place> places;
  for (const KeyframeId id : now) {
    const Pose& pose = child.find_keyframe(id)->camera_from_world;
    Place place{keyframes_at(child, now, pose),
                std::max(static_cast<std::size_t>(budget), keyframes_at(parent, before, pose).size())};
    if (place.keyframes.size() > place.budget) places.push_back(std::move(place));
  }
  return places;
}

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

std::vector<KeyframeId> keyframes_at(const MapGraph& map, std::span<const KeyframeId> among,
                                     const Pose& camera_from_world) {
  constexpr double kNear = 1.0;     // metres
  constexpr double kMaxTurn = 0.5;  // radians
  std::vector<KeyframeId> keyframes;
  std::ranges::copy_if(among, std::back_inserter(keyframes), [&](KeyframeId id) {
    const Pose change = camera_from_world * inverse(map.keyframe_header(id)->camera_from_world);
    return change.translation.norm() <= kNear && rotation_log(change.rotation).norm() <= kMaxTurn;
  });
  return keyframes;
}

int keep_to_budget(const MapGraph& parent, int budget, std::span<const Survival> survival,
                   const std::function<bool(const Keyframe&)>& is_kept, MapGraph& child) {
  std::vector<Place> places = overfull_places(parent, budget, child);
  for (int removed = 0;; ++removed) {
    std::optional<KeyframeId> least_useful;
    double least = 0.0;
    for (const Place& place : places) {
      for (const KeyframeId id : place.keyframes) {
        const Keyframe& keyframe = *child.find_keyframe(id);
        if (!keyframe.parent || is_kept(keyframe)) continue;
        const double useful = usefulness(child, keyframe, survival);
        if (!least_useful || useful < least) std::tie(least_useful, least) = std::pair(id, useful);
      }
    }
    if (!least_useful) return removed;
    remove(*least_useful, child);
    for (Place& place : places) std::erase(place.keyframes, *least_useful);
    std::erase_if(places, [](const Place& place) { return place.keyframes.size() <= place.budget; });
  }
}

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
