#include "byre/slam/window/window.h"

#include <algorithm>
#include <cassert>
#include <iterator>
#include <span>
#include <unordered_map>
#include <utility>

namespace byre {
namespace {

// New keyframes, then those most covisible with the centre, up to the limit.
std::vector<KeyframeId> choose_movable(const MapGraph& map, const std::vector<KeyframeId>& new_keyframes, int limit) {
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

// Mapping needs no words, and a window may contain a whole map.
Keyframe without_words(const Keyframe& keyframe) {
  return {keyframe.frame,      keyframe.rig,       keyframe.recording, keyframe.camera_from_world,
          keyframe.covariance, keyframe.sightings, keyframe.parent,    {}};
}

void append_keyframe(MapWindow& window, const MapView& map, KeyframeId id, bool movable, bool is_new) {
  const Keyframe& keyframe = *map.find_keyframe(id);
  WindowKeyframe copy{id, without_words(keyframe), std::vector<int>(keyframe.sightings.size(), kNoPoint), movable,
                      is_new};
  for (std::size_t feature = 0; feature < keyframe.sightings.size(); ++feature) {
    if (keyframe.sightings[feature].point) copy.point_of_feature[feature] = kPointElsewhere;
  }
  if (is_offline(copy)) {
    copy.keyframe.rig += static_cast<int>(map.online().rigs().size());
    for (const Observation& seen : map.online().foreign_observations(id)) {
      copy.point_of_feature[static_cast<std::size_t>(seen.feature)] = kPointElsewhere;
    }
  }
  window.keyframes.push_back(std::move(copy));
}

std::vector<Rig> rigs_of(const MapView& map) {
  std::vector<Rig> rigs = map.online().rigs();
  if (map.offline() != nullptr) rigs.insert(rigs.end(), map.offline()->rigs().begin(), map.offline()->rigs().end());
  return rigs;
}

// Points that these keyframes see without foreign views, ascending.
std::vector<PointId> points_seen(std::span<const WindowKeyframe> keyframes, const MapView& map) {
  std::vector<PointId> ids;
  for (const WindowKeyframe& keyframe : keyframes) {
    for (const Sighting& sighting : keyframe.keyframe.sightings) {
      if (sighting.point && map.find_point(*sighting.point) != nullptr) ids.push_back(*sighting.point);
    }
  }
  std::sort(ids.begin(), ids.end());
  ids.erase(std::unique(ids.begin(), ids.end()), ids.end());
  return ids;
}

void append_points(MapWindow& window, const MapView& map, const std::vector<PointId>& ids) {
  window.points.reserve(ids.size());
  for (const PointId id : ids) window.points.push_back({id, *map.find_point(id), {}, 0, false});
}

struct HashOfKeyframe {
  std::size_t operator()(KeyframeId id) const {
    return (static_cast<std::size_t>(id.origin) << 32U) | static_cast<std::size_t>(id.number);
  }
};
using NumberOfKeyframe = std::unordered_map<KeyframeId, int, HashOfKeyframe>;

NumberOfKeyframe index_keyframes(const MapWindow& window) {
  NumberOfKeyframe index;
  for (std::size_t i = 0; i < window.keyframes.size(); ++i) index[window.keyframes[i].id] = static_cast<int>(i);
  return index;
}

// -1 for a keyframe outside the window.
int find(const NumberOfKeyframe& index, KeyframeId id) {
  const auto found = index.find(id);
  return found == index.end() ? -1 : found->second;
}

// Keyframes that see these points, those that see most of them first.
std::vector<KeyframeId> rank_anchors(const MapView& map, const std::vector<PointId>& points) {
  NumberOfKeyframe shared;
  for (const PointId point : points) {
    map.visit_views(point, [&](const Observation& observation) { ++shared[observation.keyframe]; });
  }
  std::vector<std::pair<int, KeyframeId>> ranked;
  for (const auto& [id, count] : shared) ranked.emplace_back(-count, id);
  std::sort(ranked.begin(), ranked.end());
  std::vector<KeyframeId> anchors;
  for (const auto& [count, id] : ranked) anchors.push_back(id);
  return anchors;
}

int sightings_of_offline(const MapWindow& window) {
  int count = 0;
  for (const WindowKeyframe& keyframe : window.keyframes) {
    if (!keyframe.movable) continue;
    count += static_cast<int>(std::ranges::count_if(keyframe.keyframe.sightings, [](const Sighting& sighting) {
      return sighting.point && sighting.point->origin == Origin::offline;
    }));
  }
  return count;
}

// Appends keyframes of one map that are not in the window yet, up to `limit` anchors of that map.
void append_anchors(MapWindow& window, const MapView& map, const std::vector<KeyframeId>& ranked, Origin origin,
                    int limit) {
  const auto is_anchor = [&](const WindowKeyframe& keyframe) {
    return keyframe.id.origin == origin && !keyframe.movable;
  };
  auto room = limit - static_cast<int>(std::ranges::count_if(window.keyframes, is_anchor));
  for (const KeyframeId id : ranked) {
    if (room <= 0) return;
    if (id.origin != origin || std::ranges::find(window.keyframes, id, &WindowKeyframe::id) != window.keyframes.end()) {
      continue;
    }
    append_keyframe(window, map, id, false, false);
    --room;
  }
}

// Appends the offline keyframes that share most points with the new keyframes, which are first in the window, then
// others. Returns the points that they see.
std::vector<PointId> append_offline_anchors(MapWindow& window, const MapView& map,
                                            const std::vector<KeyframeId>& ranked, int limit) {
  if (map.offline() == nullptr) return {};
  const auto movable = window.keyframes.size();
  const auto is_old = std::ranges::find(window.keyframes, false, &WindowKeyframe::is_new);
  const auto new_count = static_cast<std::size_t>(is_old - window.keyframes.begin());
  const std::vector<PointId> seen_by_new = points_seen(std::span(window.keyframes).first(new_count), map);
  append_anchors(window, map, rank_anchors(map, seen_by_new), Origin::offline, limit);
  append_anchors(window, map, ranked, Origin::offline, limit);
  return points_seen(std::span(window.keyframes).subspan(movable), map);
}

std::vector<PointId> united(const std::vector<PointId>& first, const std::vector<PointId>& second) {
  std::vector<PointId> all;
  std::ranges::set_union(first, second, std::back_inserter(all));
  return all;
}

void link_observation(MapWindow& window, int point, const WindowObservation& seen) {
  window.point(point).observations.push_back(seen);
  window.keyframe(seen.keyframe).point_of_feature[static_cast<std::size_t>(seen.feature)] = point;
}

void link_observations(MapWindow& window, const MapView& map) {
  const NumberOfKeyframe index = index_keyframes(window);
  for (int p = 0; p < static_cast<int>(window.points.size()); ++p) {
    WindowPoint& point = window.point(p);
    map.visit_observations(*point.id, [&](const Observation& observation) {
      const int keyframe = find(index, observation.keyframe);
      if (keyframe < 0) {
        ++point.observations_elsewhere;
      } else {
        link_observation(window, p, {keyframe, observation.feature});
      }
    });
  }
}

// Copies the online map's foreign views into the window's offline keyframes.
void link_foreign_views(MapWindow& window, const MapView& map) {
  const NumberOfKeyframe index = index_keyframes(window);
  for (int p = 0; p < static_cast<int>(window.points.size()); ++p) {
    WindowPoint& point = window.point(p);
    for (const auto& [observation, sighting] : map.online().foreign_views(*point.id)) {
      const int keyframe = find(index, observation.keyframe);
      if (keyframe < 0) {
        ++point.foreign_views_elsewhere;
        continue;
      }
      link_observation(window, p, {keyframe, observation.feature});
      window.keyframe(keyframe).keyframe.sightings[static_cast<std::size_t>(observation.feature)] = sighting;
    }
  }
}

bool is_online_anchor(const WindowKeyframe& keyframe) {
  return !is_offline(keyframe) && !keyframe.movable;
}

}  // namespace

MapWindow cut_window(const MapView& map, const std::vector<KeyframeId>& new_keyframes, const WindowOptions& options) {
  MapWindow window;
  window.rigs = rigs_of(map);
  for (const KeyframeId id : choose_movable(map.online(), new_keyframes, options.movable)) {
    const bool is_new = std::find(new_keyframes.begin(), new_keyframes.end(), id) != new_keyframes.end();
    append_keyframe(window, map, id, true, is_new);
  }
  const std::vector<PointId> points = points_seen(window.keyframes, map);
  const std::vector<KeyframeId> ranked = rank_anchors(map, points);
  append_points(window, map, united(points, append_offline_anchors(window, map, ranked, options.offline_anchors)));
  if (sightings_of_offline(window) < options.sightings_in_place_of_anchors) {
    append_anchors(window, map, ranked, Origin::online, options.anchors);
  }
  link_observations(window, map);
  link_foreign_views(window, map);
  fix_gauge(window, options.min_offline_sightings);
  return window;
}

MapWindow window_of(const MapView& map, const std::vector<KeyframeId>& keyframes,
                    const std::vector<KeyframeId>& others) {
  MapWindow window;
  window.rigs = rigs_of(map);
  for (const KeyframeId id : others) append_keyframe(window, map, id, false, false);
  for (const KeyframeId id : keyframes) append_keyframe(window, map, id, false, false);
  append_points(window, map, points_seen(std::span(window.keyframes).subspan(others.size()), map));
  link_observations(window, map);
  link_foreign_views(window, map);
  return window;
}

MapWindow window_of_both_maps(const MapView& map) {
  constexpr int kMostOffline = 1000;  // bounds the memory on the map of a large site
  MapWindow window;
  window.rigs = rigs_of(map);
  for (const KeyframeId id : map.online().keyframe_ids()) append_keyframe(window, map, id, true, false);
  const std::vector<KeyframeId> ranked = rank_anchors(map, points_seen(window.keyframes, map));
  append_anchors(window, map, ranked, Origin::offline, kMostOffline);
  for (WindowKeyframe& keyframe : window.keyframes) keyframe.movable = true;
  append_points(window, map, points_seen(window.keyframes, map));
  link_observations(window, map);
  link_foreign_views(window, map);
  return window;
}

void fix_gauge(MapWindow& window, int min_offline_sightings) {
  int sightings = 0;
  for (const WindowKeyframe& keyframe : window.keyframes) {
    if (keyframe.movable) sightings += count_offline_sightings(window, keyframe);
  }
  if (sightings >= min_offline_sightings) return;
  for (WindowKeyframe& keyframe : window.keyframes) keyframe.movable &= keyframe.keyframe.parent.has_value();
  if (sightings == 0 || std::ranges::any_of(window.keyframes, is_online_anchor)) return;
  const auto age = [](const WindowKeyframe& keyframe) { return std::pair(is_offline(keyframe), keyframe.id); };
  std::ranges::min_element(window.keyframes, {}, age)->movable = false;
}

std::vector<int> nearest_neighbours(const MapWindow& window, int keyframe, int online_count, int offline_count) {
  std::vector<int> online, offline;
  for (int i = 0; i < static_cast<int>(window.keyframes.size()); ++i) {
    if (i != keyframe) (is_offline(window.keyframe(i)) ? offline : online).push_back(i);
  }
  online.resize(std::min(online.size(), static_cast<std::size_t>(online_count)));
  offline.resize(std::min(offline.size(), static_cast<std::size_t>(offline_count)));
  online.insert(online.end(), offline.begin(), offline.end());
  return online;
}

int count_offline_sightings(const MapWindow& window, const WindowKeyframe& keyframe) {
  return static_cast<int>(std::ranges::count_if(
      keyframe.point_of_feature, [&](int point) { return point >= 0 && is_offline(window.point(point)); }));
}

bool is_fixed(const MapWindow& window, const WindowPoint& point) {
  return is_offline(point) && std::ranges::none_of(point.observations, [&](const WindowObservation& seen) {
           const WindowKeyframe& keyframe = window.keyframe(seen.keyframe);
           return is_offline(keyframe) && keyframe.movable;
         });
}

std::optional<WindowObservation> first_online_observation(const MapWindow& window, const WindowPoint& point) {
  const auto found = std::ranges::find_if(
      point.observations, [&](const WindowObservation& seen) { return !is_offline(window.keyframe(seen.keyframe)); });
  return found == point.observations.end() ? std::nullopt : std::optional(*found);
}

void add_observation(MapWindow& window, int point, const WindowObservation& observation, const Sighting& sighting) {
  WindowKeyframe& keyframe = window.keyframe(observation.keyframe);
  const auto feature = static_cast<std::size_t>(observation.feature);
  assert(!is_offline(keyframe) || !is_offline(window.point(point)));
  keyframe.point_of_feature[feature] = point;
  keyframe.keyframe.sightings[feature] = sighting;
  window.point(point).observations.push_back(observation);
}

void remove_observation(MapWindow& window, const WindowObservation& observation) {
  int& slot = window.keyframe(observation.keyframe).point_of_feature[static_cast<std::size_t>(observation.feature)];
  auto& observations = window.point(slot).observations;
  std::erase_if(observations, [&](const WindowObservation& other) {
    return other.keyframe == observation.keyframe && other.feature == observation.feature;
  });
  slot = kNoPoint;
}

void remove_point(MapWindow& window, int point) {
  WindowPoint& removed = window.point(point);
  for (const WindowObservation& observation : removed.observations) {
    window.keyframe(observation.keyframe).point_of_feature[static_cast<std::size_t>(observation.feature)] = kNoPoint;
  }
  removed.observations.clear();
  removed.removed = true;
}

}  // namespace byre
