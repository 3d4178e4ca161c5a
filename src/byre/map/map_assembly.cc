// Construction of a map from all its parts, with all derived data computed at once.

#include "byre/map/map_graph.h"

#include <algorithm>
#include <utility>

namespace byre {

MapGraph::MapGraph(Origin origin, MapParts parts)
    : origin_(origin),
      rigs_(std::move(parts.rigs)),
      points_(parts.points.size()),
      point_slots_(parts.points.size()),
      keyframe_count_(static_cast<int>(parts.keyframes.size())),
      point_count_(static_cast<int>(parts.points.size())) {
  keyframes_.resize(parts.keyframes.size());
  for (std::uint32_t i = 0; i < keyframes_.size(); ++i) {
    if (const auto parent = parts.keyframes[i].parent) edit_slot(*parent).children.push_back({origin_, i});
    keyframes_[i].edit().keyframe = std::move(parts.keyframes[i]);
  }
  for (std::size_t i = 0; i < points_.size(); ++i) {
    point_slots_.edit(i) = static_cast<std::uint32_t>(i);
    points_.edit(i).point = parts.points[i];
  }
  collect_observations();
  count_covisible_keyframes();
}

MapGraph::MapGraph(std::vector<Rig> rigs, std::vector<Keyframe> headers, int point_count,
                   std::shared_ptr<const MapSource> source)
    : origin_(Origin::offline),
      rigs_(std::move(rigs)),
      source_(std::move(source)),
      keyframe_count_(static_cast<int>(headers.size())),
      point_count_(point_count) {
  keyframes_.reserve(headers.size());
  for (Keyframe& header : headers) keyframes_.emplace_back().edit().keyframe = std::move(header);
}

void MapGraph::read_from_source() {
  MapParts parts{rigs_, {}, {}};
  parts.keyframes.reserve(keyframes_.size());
  parts.points.reserve(static_cast<std::size_t>(point_count_));
  for (const KeyframeId id : keyframe_ids()) parts.keyframes.push_back(*find_keyframe(id));
  for (const PointId id : point_ids()) parts.points.push_back(*find_point(id));
  if (const InputError* const fault = damage()) throw InputError(*fault);
  *this = MapGraph(origin_, std::move(parts));
}

// Keyframes are in ascending order, so the observations of a point are too.
void MapGraph::collect_observations() {
  std::vector<std::size_t> observers(points_.size(), 0);
  for (const Shared<KeyframeSlot>& keyframe_slot : keyframes_) {
    for (const Sighting& sighting : keyframe_slot->keyframe->sightings) {
      if (sighting.point) ++observers[sighting.point->number];
    }
  }
  for (std::size_t i = 0; i < points_.size(); ++i) points_.edit(i).observations.reserve(observers[i]);
  for (std::uint32_t i = 0; i < keyframes_.size(); ++i) {
    const std::vector<Sighting>& sightings = keyframes_[i]->keyframe->sightings;
    for (std::size_t feature = 0; feature < sightings.size(); ++feature) {
      if (!sightings[feature].point) continue;
      points_.edit(sightings[feature].point->number).observations.push_back({{origin_, i}, static_cast<int>(feature)});
    }
  }
}

void MapGraph::count_covisible_keyframes() {
  std::vector<int> shared_points(keyframes_.size(), 0);
  std::vector<std::uint32_t> seen;  // keyframes with a non-zero count
  for (std::uint32_t i = 0; i < keyframes_.size(); ++i) {
    for (const Sighting& sighting : keyframes_[i]->keyframe->sightings) {
      if (!sighting.point) continue;
      for (const Observation& other : points_[sighting.point->number].observations) {
        if (shared_points[other.keyframe.number]++ == 0) seen.push_back(other.keyframe.number);
      }
    }
    std::ranges::sort(seen);
    std::vector<Covisible>& covisible = keyframes_[i].edit().covisible;
    covisible.reserve(seen.size());
    for (const std::uint32_t other : seen) {
      const int count = std::exchange(shared_points[other], 0);
      if (other != i) covisible.push_back({{origin_, other}, count});
    }
    seen.clear();
  }
}

}  // namespace byre
