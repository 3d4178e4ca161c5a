#include "byre/slam/window.h"

#include <algorithm>
#include <map>
#include <set>

namespace byre {
namespace {

// New keyframes, then those most covisible with the centre, up to the limit.
std::vector<KeyframeId> choose_movable(const Map& map, const std::vector<KeyframeId>& new_keyframes, int limit) {
  std::vector<KeyframeId> chosen;
  for (auto id = new_keyframes.rbegin(); id != new_keyframes.rend(); ++id) {
    if (map.find_keyframe(*id) != nullptr) chosen.push_back(*id);
  }
  if (chosen.empty()) return chosen;
  for (const Covisible& neighbour : map.covisible_keyframes(chosen.front(), limit)) {
    if (static_cast<int>(chosen.size()) >= limit) break;
    if (std::find(chosen.begin(), chosen.end(), neighbour.keyframe) == chosen.end()) {
      chosen.push_back(neighbour.keyframe);
    }
  }
  return chosen;
}

void append_keyframe(MapWindow& window, const Map& map, KeyframeId id, bool movable, bool is_new) {
  const Keyframe& keyframe = *map.find_keyframe(id);
  WindowKeyframe copy{id, keyframe, std::vector<int>(keyframe.sightings.size(), kNoPoint), movable, is_new};
  for (std::size_t feature = 0; feature < keyframe.sightings.size(); ++feature) {
    if (keyframe.sightings[feature].point) copy.point_of_feature[feature] = kPointElsewhere;
  }
  window.keyframes.push_back(std::move(copy));
}

// All points that the window's keyframes see so far.
void append_points(MapWindow& window, const Map& map) {
  std::vector<PointId> ids;
  for (const WindowKeyframe& keyframe : window.keyframes) {
    for (const Sighting& sighting : keyframe.keyframe.sightings) {
      if (sighting.point && map.find_point(*sighting.point) != nullptr) ids.push_back(*sighting.point);
    }
  }
  std::sort(ids.begin(), ids.end());
  ids.erase(std::unique(ids.begin(), ids.end()), ids.end());
  window.points.reserve(ids.size());
  for (const PointId id : ids) window.points.push_back({id, *map.find_point(id), {}, 0, false});
}

// Keyframes outside the window that see its points, those that see most of them first.
std::vector<KeyframeId> choose_anchors(const MapWindow& window, const Map& map, int limit) {
  std::set<KeyframeId> inside;
  for (const WindowKeyframe& keyframe : window.keyframes) inside.insert(keyframe.id);
  std::map<KeyframeId, int> shared;
  for (const WindowPoint& point : window.points) {
    for (const Observation& observation : map.observations(*point.id)) {
      if (!inside.contains(observation.keyframe)) ++shared[observation.keyframe];
    }
  }
  std::vector<std::pair<int, KeyframeId>> ranked;
  for (const auto& [id, count] : shared) ranked.emplace_back(-count, id);
  std::sort(ranked.begin(), ranked.end());
  std::vector<KeyframeId> anchors;
  for (const auto& [count, id] : ranked) {
    if (static_cast<int>(anchors.size()) >= limit) break;
    anchors.push_back(id);
  }
  return anchors;
}

// Where the map's keyframes are in the window, by number; -1 for those that are not in it.
std::vector<int> index_by_number(const MapWindow& window, Origin origin) {
  std::vector<int> index;
  for (std::size_t i = 0; i < window.keyframes.size(); ++i) {
    const KeyframeId id = window.keyframes[i].id;
    if (id.origin != origin) continue;
    if (id.number >= index.size()) index.resize(id.number + std::size_t{1}, -1);
    index[id.number] = static_cast<int>(i);
  }
  return index;
}

void link_observations(MapWindow& window, const Map& map) {
  const std::vector<int> index_of = index_by_number(window, map.origin());
  for (std::size_t p = 0; p < window.points.size(); ++p) {
    WindowPoint& point = window.points[p];
    for (const Observation& observation : map.observations(*point.id)) {
      const std::uint32_t number = observation.keyframe.number;
      const int keyframe = number < index_of.size() ? index_of[number] : -1;
      if (keyframe < 0) {
        ++point.observations_elsewhere;
        continue;
      }
      point.observations.push_back({keyframe, observation.feature});
      window.keyframes[static_cast<std::size_t>(keyframe)]
          .point_of_feature[static_cast<std::size_t>(observation.feature)] = static_cast<int>(p);
    }
  }
}

}  // namespace

MapWindow cut_window(const Map& map, const std::vector<KeyframeId>& new_keyframes, const WindowOptions& options) {
  MapWindow window;
  window.rigs = map.rigs();
  for (const KeyframeId id : choose_movable(map, new_keyframes, options.movable)) {
    const bool is_new = std::find(new_keyframes.begin(), new_keyframes.end(), id) != new_keyframes.end();
    const bool is_first = !map.find_keyframe(id)->parent.has_value();
    append_keyframe(window, map, id, !is_first, is_new);
  }
  append_points(window, map);
  for (const KeyframeId id : choose_anchors(window, map, options.anchors)) {
    append_keyframe(window, map, id, false, false);
  }
  link_observations(window, map);
  return window;
}

MapWindow window_of(const Map& map, const std::vector<KeyframeId>& keyframes) {
  MapWindow window;
  window.rigs = map.rigs();
  for (const KeyframeId id : keyframes) append_keyframe(window, map, id, false, false);
  append_points(window, map);
  link_observations(window, map);
  return window;
}

void add_observation(MapWindow& window, int point, const WindowObservation& observation, const Sighting& sighting) {
  WindowKeyframe& keyframe = window.keyframes[static_cast<std::size_t>(observation.keyframe)];
  const auto feature = static_cast<std::size_t>(observation.feature);
  keyframe.point_of_feature[feature] = point;
  keyframe.keyframe.sightings[feature] = sighting;
  window.points[static_cast<std::size_t>(point)].observations.push_back(observation);
}

void remove_observation(MapWindow& window, const WindowObservation& observation) {
  int& slot = window.keyframes[static_cast<std::size_t>(observation.keyframe)]
                  .point_of_feature[static_cast<std::size_t>(observation.feature)];
  auto& observations = window.points[static_cast<std::size_t>(slot)].observations;
  std::erase_if(observations, [&](const WindowObservation& other) {
    return other.keyframe == observation.keyframe && other.feature == observation.feature;
  });
  slot = kNoPoint;
}

void remove_point(MapWindow& window, int point) {
  WindowPoint& removed = window.points[static_cast<std::size_t>(point)];
  for (const WindowObservation& observation : removed.observations) {
    window.keyframes[static_cast<std::size_t>(observation.keyframe)]
        .point_of_feature[static_cast<std::size_t>(observation.feature)] = kNoPoint;
  }
  removed.observations.clear();
  removed.removed = true;
}

}  // namespace byre
