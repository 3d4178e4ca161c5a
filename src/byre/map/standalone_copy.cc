#include "byre/map/map_view.h"

#include <algorithm>
#include <vector>

namespace byre {
namespace {

// Offline points with observations by online keyframes, ascending.
std::vector<PointId> offline_points_seen(const MapView& map) {
  std::vector<PointId> seen;
  for (const KeyframeId id : map.online().keyframe_ids()) {
    for (const Sighting& sighting : map.online().find_keyframe(id)->sightings) {
      const bool is_offline = sighting.point && sighting.point->origin == Origin::offline;
      if (is_offline && map.find_point(*sighting.point) != nullptr) seen.push_back(*sighting.point);
    }
  }
  std::ranges::sort(seen);
  seen.erase(std::unique(seen.begin(), seen.end()), seen.end());
  return seen;
}

// Replaces an offline point by a copy in `copy`, with its observations.
void adopt(const MapPoint& offline, PointId offline_id, MapGraph& copy) {
  const std::vector<Observation> observers = copy.observations(offline_id);
  MapPoint adopted = offline;
  adopted.reference = observers.front();
  const PointId id = copy.add_point(adopted);
  for (const Observation& observation : observers) {
    Sighting sighting =
        copy.find_keyframe(observation.keyframe)->sightings[static_cast<std::size_t>(observation.feature)];
    sighting.point = id;
    copy.remove_observation(observation);
    copy.add_observation(observation, sighting);
  }
}

void drop_foreign_views(MapGraph& copy) {
  for (const PointId id : copy.point_ids()) {
    const std::vector<ForeignView> views = copy.foreign_views(id);
    for (const ForeignView& view : views) copy.remove_foreign_view(view.observation);
  }
}

}  // namespace

MapGraph standalone_copy(const MapView& map) {
  MapGraph copy = map.online();
  for (const PointId id : offline_points_seen(map)) adopt(*map.find_point(id), id, copy);
  drop_foreign_views(copy);
  return copy;
}

}  // namespace byre
