#include "byre/slam/window/delta.h"

#include <array>
#include <cassert>

namespace byre {
namespace {

bool is_online(PointId id) {
  return id.origin == Origin::online;
}

bool same(const Pose& a, const Pose& b) {
  return a.translation == b.translation && a.rotation.coeffs() == b.rotation.coeffs();
}

bool same(const MapPoint& a, const MapPoint& b) {
  return a.position_in_world == b.position_in_world && a.covariance == b.covariance && a.descriptor == b.descriptor &&
         a.mean_viewing_direction == b.mean_viewing_direction && a.max_distance == b.max_distance &&
         a.reference == b.reference;
}

class WindowBefore {
 public:
  explicit WindowBefore(const MapWindow& window) : window_(window) {}

  std::size_t point_count() const { return window_.points.size(); }
  const MapPoint& point(std::size_t index) const { return window_.points[index].point; }
  const Pose& camera_from_world(std::size_t keyframe) const {
    return window_.keyframes[keyframe].keyframe.camera_from_world;
  }
  const std::vector<int>& point_of_feature(std::size_t keyframe) const {
    return window_.keyframes[keyframe].point_of_feature;
  }

 private:
  const MapWindow& window_;
};

// State of the window by the map that it was cut from.
class MapBefore {
 public:
  MapBefore(const MapGraph& map, const MapWindow& after) : map_(map), after_(after) {
    while (point_count_ < after.points.size() && after.points[point_count_].id) {
      const PointId id = *after.points[point_count_].id;
      std::vector<int>& index = index_of_[static_cast<std::size_t>(id.origin)];
      if (index.size() <= id.number) index.resize(id.number + std::size_t{1}, kPointElsewhere);
      index[id.number] = static_cast<int>(point_count_++);
    }
  }

  std::size_t point_count() const { return point_count_; }
  const MapPoint& point(std::size_t index) const { return *map_.find_point(*after_.points[index].id); }
  const Pose& camera_from_world(std::size_t keyframe) const {
    return map_.find_keyframe(after_.keyframes[keyframe].id)->camera_from_world;
  }
  std::vector<int> point_of_feature(std::size_t keyframe) const {
    std::vector<int> points;
    for (const Sighting& sighting : map_.find_keyframe(after_.keyframes[keyframe].id)->sightings) {
      points.push_back(sighting.point ? index_of(*sighting.point) : kNoPoint);
    }
    return points;
  }

 private:
  int index_of(PointId id) const {
    const std::vector<int>& index = index_of_[static_cast<std::size_t>(id.origin)];
    return id.number < index.size() ? index[id.number] : kPointElsewhere;
  }

  const MapGraph& map_;
  const MapWindow& after_;
  std::size_t point_count_ = 0;               // points without the new ones
  std::array<std::vector<int>, 2> index_of_;  // index in the window, by origin and number
};

template <typename Before>
void append_point_changes(const Before& before, const MapWindow& after, MapDelta& delta) {
  for (std::size_t i = 0; i < before.point_count(); ++i) {
    const PointId id = *after.points[i].id;
    if (!is_online(id)) continue;
    if (after.points[i].removed) {
      delta.removed_points.push_back({id.number});
    } else if (!same(before.point(i), after.points[i].point)) {
      delta.updated_points.push_back({{id.number}, after.points[i].point});
    }
  }
}

// A feature whose point has changed. Indices into the points of the window, or negative.
struct ChangedFeature {
  int feature = 0;
  int then = kNoPoint;
  int now = kNoPoint;
};

// Without removed and new points, which the delta lists as a whole.
template <typename Before>
std::vector<ChangedFeature> changed_features(const Before& before, const MapWindow& after, std::size_t keyframe) {
  const std::vector<int>& then = before.point_of_feature(keyframe);
  const std::vector<int>& now = after.keyframes[keyframe].point_of_feature;
  std::vector<ChangedFeature> changed;
  for (std::size_t f = 0; f < then.size(); ++f) {
    if (then[f] == now[f]) continue;
    const bool was_lost = then[f] >= 0 && !after.point(then[f]).removed;
    const bool is_known = now[f] >= 0 && static_cast<std::size_t>(now[f]) < before.point_count();
    changed.push_back({static_cast<int>(f), was_lost ? then[f] : kNoPoint, is_known ? now[f] : kNoPoint});
  }
  return changed;
}

Sighting sighting_of(const WindowKeyframe& keyframe, int feature, std::optional<PointId> point) {
  Sighting sighting = keyframe.keyframe.sightings[static_cast<std::size_t>(feature)];
  sighting.point = point;
  return sighting;
}

template <typename Before>
void append_observation_changes(const Before& before, const MapWindow& after, std::size_t keyframe, MapDelta& delta) {
  const WindowKeyframe& now = after.keyframes[keyframe];
  const OnlineKeyframeId id{now.id.number};
  for (const ChangedFeature& changed : changed_features(before, after, keyframe)) {
    if (changed.then >= 0) {
      const PointId point = *after.point(changed.then).id;
      delta.removed_observations.push_back({id, changed.feature, point});
    }
    if (changed.now >= 0) {
      const std::optional<PointId> point = after.point(changed.now).id;
      delta.new_observations.push_back({id, changed.feature, sighting_of(now, changed.feature, point)});
    }
  }
}

// Changes at an offline keyframe: only its foreign views in the online map can change.
template <typename Before>
void append_foreign_view_changes(const Before& before, const MapWindow& after, std::size_t keyframe, MapDelta& delta) {
  const WindowKeyframe& now = after.keyframes[keyframe];
  for (const ChangedFeature& changed : changed_features(before, after, keyframe)) {
    const Observation observation{now.id, changed.feature};
    if (changed.then >= 0) {
      const PointId point = *after.point(changed.then).id;
      assert(is_online(point));
      delta.removed_foreign_views.push_back({{point.number}, observation});
    }
    if (changed.now >= 0) {
      const PointId point = *after.point(changed.now).id;
      assert(is_online(point));
      delta.new_foreign_views.push_back({{point.number}, {observation, sighting_of(now, changed.feature, point)}});
    }
  }
}

void append_new_points(std::size_t known, const MapWindow& after, MapDelta& delta) {
  for (std::size_t i = known; i < after.points.size(); ++i) {
    const WindowPoint& point = after.points[i];
    if (point.removed) continue;
    NewPoint made{point.point, {}, {}};
    for (const WindowObservation& seen : point.observations) {
      const WindowKeyframe& keyframe = after.keyframe(seen.keyframe);
      const Sighting& sighting = keyframe.keyframe.sightings[static_cast<std::size_t>(seen.feature)];
      if (is_offline(keyframe)) {
        made.foreign_views.push_back({{keyframe.id, seen.feature}, sighting});
      } else {
        made.observations.push_back({{keyframe.id.number}, seen.feature, sighting});
      }
    }
    delta.new_points.push_back(std::move(made));
  }
}

void add_new_point(const NewPoint& made, MapGraph& online) {
  const PointId id = online.add_point(made.point);
  int added = 0;
  for (const NewObservation& observation : made.observations) {
    Sighting sighting = observation.sighting;
    sighting.point = id;
    added += online.add_observation({observation.keyframe, observation.feature}, sighting) ? 1 : 0;
  }
  for (ForeignView view : made.foreign_views) {
    view.sighting.point = id;
    added += online.add_foreign_view(view) ? 1 : 0;
  }
  // Its keyframes may have got other points, or been removed, while the job ran.
  const Keyframe* const reference = online.find_keyframe(made.point.reference.keyframe);
  const bool reference_sees_it =
      reference != nullptr && reference->sightings[static_cast<std::size_t>(made.point.reference.feature)].point == id;
  if (added < 2 || !reference_sees_it) online.remove_point(id);
}

// Removals before additions: no point depends on its foreign views.
void change_foreign_views(const MapDelta& delta, MapGraph& online) {
  for (const RemovedForeignView& removed : delta.removed_foreign_views) {
    if (online.point_of_foreign_view(removed.observation) == PointId(removed.point)) {
      online.remove_foreign_view(removed.observation);
    }
  }
  for (const NewForeignView& added : delta.new_foreign_views) {
    ForeignView view = added.view;
    view.sighting.point = PointId(added.point);
    online.add_foreign_view(view);
  }
}

// Existing observations stay.
void add_observations(const MapDelta& delta, MapGraph& online) {
  for (const NewObservation& added : delta.new_observations) {
    online.add_observation({added.keyframe, added.feature}, added.sighting);
  }
}

void remove_observations(const MapDelta& delta, MapGraph& online) {
  for (const RemovedObservation& removed : delta.removed_observations) {
    const Keyframe* const keyframe = online.find_keyframe(removed.keyframe);
    if (keyframe == nullptr) continue;
    if (keyframe->sightings[static_cast<std::size_t>(removed.feature)].point != removed.point) continue;
    online.remove_observation({removed.keyframe, removed.feature});
  }
}

template <typename Before>
MapDelta difference_to(const Before& before, const MapWindow& after) {
  MapDelta delta;
  append_point_changes(before, after, delta);
  for (std::size_t i = 0; i < after.keyframes.size(); ++i) {
    const WindowKeyframe& now = after.keyframes[i];
    if (is_offline(now)) {
      append_foreign_view_changes(before, after, i, delta);
      continue;
    }
    if (now.removed) {
      delta.removed_keyframes.push_back({now.id.number});
      continue;
    }
    if (!same(before.camera_from_world(i), now.keyframe.camera_from_world)) {
      delta.moved_keyframes.push_back({{now.id.number}, now.keyframe.camera_from_world, now.keyframe.covariance});
    }
    append_observation_changes(before, after, i, delta);
  }
  append_new_points(before.point_count(), after, delta);
  return delta;
}

}  // namespace

MapWindow outline_of(const MapWindow& window) {
  MapWindow outline;
  outline.rigs = window.rigs;
  outline.motions = window.motions;
  outline.keyframes.reserve(window.keyframes.size());
  for (const WindowKeyframe& entry : window.keyframes) {
    const Keyframe& keyframe = entry.keyframe;
    outline.keyframes.push_back({entry.id,
                                 {{.time = keyframe.frame.time, .features = nullptr},
                                  keyframe.rig,
                                  keyframe.recording,
                                  keyframe.camera_from_world,
                                  keyframe.covariance,
                                  {},
                                  keyframe.parent,
                                  {}},
                                 entry.point_of_feature,
                                 entry.movable,
                                 entry.is_new,
                                 entry.removed});
  }
  outline.points.reserve(window.points.size());
  for (const WindowPoint& point : window.points) {
    outline.points.push_back({point.id, point.point, {}, 0, point.removed, 0});
  }
  return outline;
}

MapDelta difference(const MapWindow& before, const MapWindow& after) {
  return difference_to(WindowBefore(before), after);
}

MapDelta difference(const MapGraph& before, const MapWindow& after) {
  return difference_to(MapBefore(before, after), after);
}

void apply(const MapDelta& delta, MapGraph& online) {
  for (const MovedKeyframe& moved : delta.moved_keyframes) {
    online.move_keyframe(moved.id, moved.camera_from_world, moved.covariance);
  }
  for (const OnlinePointId id : delta.removed_points) online.remove_point(id);
  // Additions before removals, so that no point is without observations in between; then the additions that had to wait
  // for a free feature.
  add_observations(delta, online);
  remove_observations(delta, online);
  add_observations(delta, online);
  change_foreign_views(delta, online);
  for (const NewPoint& made : delta.new_points) add_new_point(made, online);
  for (const UpdatedPoint& updated : delta.updated_points) online.update_point(updated.id, updated.point);
  for (const OnlineKeyframeId id : delta.removed_keyframes) online.remove_keyframe(id);
}

}  // namespace byre
