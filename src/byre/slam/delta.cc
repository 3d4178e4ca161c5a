#include "byre/slam/delta.h"

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

void append_point_changes(const MapWindow& before, const MapWindow& after, MapDelta& delta) {
  for (std::size_t i = 0; i < before.points.size(); ++i) {
    const PointId id = *before.points[i].id;
    if (!is_online(id)) continue;
    if (after.points[i].removed) {
      delta.removed_points.push_back({id.number});
    } else if (!same(before.points[i].point, after.points[i].point)) {
      delta.updated_points.push_back({{id.number}, after.points[i].point});
    }
  }
}

// A feature that sees another point than before, or another one now. Indices into the points of the window, or
// negative.
struct ChangedFeature {
  int feature = 0;
  int then = kNoPoint;
  int now = kNoPoint;
};

// But for what becomes of points that are removed, or were made in the window: those are named as a whole.
std::vector<ChangedFeature> changed_features(const MapWindow& before, const MapWindow& after, std::size_t keyframe) {
  const std::vector<int>& then = before.keyframes[keyframe].point_of_feature;
  const std::vector<int>& now = after.keyframes[keyframe].point_of_feature;
  std::vector<ChangedFeature> changed;
  for (std::size_t f = 0; f < then.size(); ++f) {
    if (then[f] == now[f]) continue;
    const bool was_lost = then[f] >= 0 && !after.points[static_cast<std::size_t>(then[f])].removed;
    const bool is_known = now[f] >= 0 && static_cast<std::size_t>(now[f]) < before.points.size();
    changed.push_back({static_cast<int>(f), was_lost ? then[f] : kNoPoint, is_known ? now[f] : kNoPoint});
  }
  return changed;
}

Sighting sighting_of(const WindowKeyframe& keyframe, int feature, std::optional<PointId> point) {
  Sighting sighting = keyframe.keyframe.sightings[static_cast<std::size_t>(feature)];
  sighting.point = point;
  return sighting;
}

void append_observation_changes(const MapWindow& before, const MapWindow& after, std::size_t keyframe,
                                MapDelta& delta) {
  const WindowKeyframe& now = after.keyframes[keyframe];
  const OnlineKeyframeId id{now.id.number};
  for (const ChangedFeature& changed : changed_features(before, after, keyframe)) {
    if (changed.then >= 0) {
      const PointId point = *before.points[static_cast<std::size_t>(changed.then)].id;
      delta.removed_observations.push_back({id, changed.feature, point});
    }
    if (changed.now >= 0) {
      const std::optional<PointId> point = after.points[static_cast<std::size_t>(changed.now)].id;
      delta.new_observations.push_back({id, changed.feature, sighting_of(now, changed.feature, point)});
    }
  }
}

// Changes about an offline keyframe: only what the online map keeps of its views can change.
void append_foreign_view_changes(const MapWindow& before, const MapWindow& after, std::size_t keyframe,
                                 MapDelta& delta) {
  const WindowKeyframe& now = after.keyframes[keyframe];
  for (const ChangedFeature& changed : changed_features(before, after, keyframe)) {
    const Observation observation{now.id, changed.feature};
    if (changed.then >= 0) {
      const PointId point = *before.points[static_cast<std::size_t>(changed.then)].id;
      assert(is_online(point));
      delta.removed_foreign_views.push_back({{point.number}, observation});
    }
    if (changed.now >= 0) {
      const PointId point = *after.points[static_cast<std::size_t>(changed.now)].id;
      assert(is_online(point));
      delta.new_foreign_views.push_back({{point.number}, {observation, sighting_of(now, changed.feature, point)}});
    }
  }
}

void append_new_points(const MapWindow& before, const MapWindow& after, MapDelta& delta) {
  for (std::size_t i = before.points.size(); i < after.points.size(); ++i) {
    const WindowPoint& point = after.points[i];
    if (point.removed) continue;
    NewPoint made{point.point, {}, {}};
    for (const WindowObservation& seen : point.observations) {
      const WindowKeyframe& keyframe = after.keyframes[static_cast<std::size_t>(seen.keyframe)];
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

void add_new_point(const NewPoint& made, Map& online) {
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
  // Its keyframes may have been given other points, or have gone, while the job ran.
  const Keyframe* const reference = online.find_keyframe(made.point.reference.keyframe);
  const bool reference_sees_it =
      reference != nullptr && reference->sightings[static_cast<std::size_t>(made.point.reference.feature)].point == id;
  if (added < 2 || !reference_sees_it) online.remove_point(id);
}

// Losses before gains: no point depends on its foreign views.
void change_foreign_views(const MapDelta& delta, Map& online) {
  for (const RemovedForeignView& removed : delta.removed_foreign_views) {
    if (online.point_of_foreign_view(removed.observation) == PointId(removed.point)) {
      online.remove_foreign_view(removed.observation);
    }
  }
  for (const NewForeignView& added : delta.new_foreign_views) {
    ForeignView view = added.view;
    view.sighting.point = added.point;
    online.add_foreign_view(view);
  }
}

// What is there already stays as it is.
void add_observations(const MapDelta& delta, Map& online) {
  for (const NewObservation& added : delta.new_observations) {
    online.add_observation({added.keyframe, added.feature}, added.sighting);
  }
}

void remove_observations(const MapDelta& delta, Map& online) {
  for (const RemovedObservation& removed : delta.removed_observations) {
    const Keyframe* const keyframe = online.find_keyframe(removed.keyframe);
    if (keyframe == nullptr) continue;
    if (keyframe->sightings[static_cast<std::size_t>(removed.feature)].point != removed.point) continue;
    online.remove_observation({removed.keyframe, removed.feature});
  }
}

}  // namespace

MapDelta difference(const MapWindow& before, const MapWindow& after) {
  MapDelta delta;
  append_point_changes(before, after, delta);
  for (std::size_t i = 0; i < before.keyframes.size(); ++i) {
    const WindowKeyframe& then = before.keyframes[i];
    const WindowKeyframe& now = after.keyframes[i];
    if (is_offline(then)) {
      append_foreign_view_changes(before, after, i, delta);
      continue;
    }
    if (now.removed) {
      delta.removed_keyframes.push_back({now.id.number});
      continue;
    }
    if (!same(then.keyframe.camera_from_world, now.keyframe.camera_from_world)) {
      delta.moved_keyframes.push_back({{now.id.number}, now.keyframe.camera_from_world, now.keyframe.covariance});
    }
    append_observation_changes(before, after, i, delta);
  }
  append_new_points(before, after, delta);
  return delta;
}

void apply(const MapDelta& delta, Map& online) {
  for (const MovedKeyframe& moved : delta.moved_keyframes) {
    online.move_keyframe(moved.id, moved.camera_from_world, moved.covariance);
  }
  for (const OnlinePointId id : delta.removed_points) online.remove_point(id);
  // Gains before losses, so that no point is left without observations in between; then those gains that had to wait
  // for a feature to lose its point.
  add_observations(delta, online);
  remove_observations(delta, online);
  add_observations(delta, online);
  change_foreign_views(delta, online);
  for (const NewPoint& made : delta.new_points) add_new_point(made, online);
  for (const UpdatedPoint& updated : delta.updated_points) online.update_point(updated.id, updated.point);
  for (const OnlineKeyframeId id : delta.removed_keyframes) online.remove_keyframe(id);
}

}  // namespace byre
