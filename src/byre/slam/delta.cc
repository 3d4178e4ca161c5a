#include "byre/slam/delta.h"

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

void append_observation_changes(const MapWindow& before, const MapWindow& after, std::size_t keyframe,
                                MapDelta& delta) {
  const std::vector<int>& then = before.keyframes[keyframe].point_of_feature;
  const WindowKeyframe& now = after.keyframes[keyframe];
  const OnlineKeyframeId id{now.id.number};
  for (std::size_t f = 0; f < then.size(); ++f) {
    const int old_point = then[f];
    const int new_point = now.point_of_feature[f];
    if (old_point == new_point) continue;
    const int feature = static_cast<int>(f);
    if (old_point >= 0 && !after.points[static_cast<std::size_t>(old_point)].removed) {
      delta.removed_observations.push_back({id, feature, *before.points[static_cast<std::size_t>(old_point)].id});
    }
    const bool was_there = new_point >= 0 && static_cast<std::size_t>(new_point) < before.points.size();
    if (was_there) {
      Sighting sighting = now.keyframe.sightings[f];
      sighting.point = after.points[static_cast<std::size_t>(new_point)].id;
      delta.new_observations.push_back({id, feature, sighting});
    }
  }
}

void append_new_points(const MapWindow& before, const MapWindow& after, MapDelta& delta) {
  for (std::size_t i = before.points.size(); i < after.points.size(); ++i) {
    const WindowPoint& point = after.points[i];
    if (point.removed) continue;
    NewPoint made{point.point, {}};
    for (const WindowObservation& observation : point.observations) {
      const WindowKeyframe& keyframe = after.keyframes[static_cast<std::size_t>(observation.keyframe)];
      made.observations.push_back({{keyframe.id.number},
                                   observation.feature,
                                   keyframe.keyframe.sightings[static_cast<std::size_t>(observation.feature)]});
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
  // Its keyframes may have been given other points, or have gone, while the job ran.
  const Keyframe* const reference = online.find_keyframe(made.point.reference.keyframe);
  const bool reference_sees_it =
      reference != nullptr && reference->sightings[static_cast<std::size_t>(made.point.reference.feature)].point == id;
  if (added < 2 || !reference_sees_it) online.remove_point(id);
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
    if (then.id.origin != Origin::online) continue;
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
  for (const NewPoint& made : delta.new_points) add_new_point(made, online);
  for (const UpdatedPoint& updated : delta.updated_points) online.update_point(updated.id, updated.point);
  for (const OnlineKeyframeId id : delta.removed_keyframes) online.remove_keyframe(id);
}

}  // namespace byre
