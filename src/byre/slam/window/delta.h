#pragma once

#include "byre/slam/window/window.h"

#include <vector>

namespace byre {

// Id of a point of the online map. A separate type, so that no delta can change an offline point.
struct OnlinePointId {
  std::uint32_t number = 0;
  operator PointId() const { return {Origin::online, number}; }
};

struct OnlineKeyframeId {
  std::uint32_t number = 0;
  operator KeyframeId() const { return {Origin::online, number}; }
};

struct MovedKeyframe {
  OnlineKeyframeId id;
  Pose camera_from_world;
  Matrix6 covariance;
};

struct UpdatedPoint {
  OnlinePointId id;
  MapPoint point;
};

struct NewObservation {
  OnlineKeyframeId keyframe;
  int feature = 0;
  Sighting sighting;  // its point may be offline
};

struct RemovedObservation {
  OnlineKeyframeId keyframe;
  int feature = 0;
  PointId point;  // point that the feature saw; ignored if it sees another one now
};

// View of an online point by an offline keyframe. Stored with the point, so that offline data do not change.
struct NewForeignView {
  OnlinePointId point;
  ForeignView view;
};

struct RemovedForeignView {
  OnlinePointId point;
  Observation observation;  // removed view; ignored if it is of another point now
};

struct NewPoint {
  MapPoint point;
  std::vector<NewObservation> observations;  // sightings; their point is set once the new point has an id
  std::vector<ForeignView> foreign_views;    // foreign views; their point is set once the new point has an id
};

// All that mapping may write. Names only online things, so an offline map cannot change.
struct MapDelta {
  std::vector<MovedKeyframe> moved_keyframes;
  std::vector<UpdatedPoint> updated_points;
  std::vector<OnlinePointId> removed_points;
  std::vector<RemovedObservation> removed_observations;
  std::vector<NewObservation> new_observations;
  std::vector<RemovedForeignView> removed_foreign_views;
  std::vector<NewForeignView> new_foreign_views;
  std::vector<NewPoint> new_points;
  std::vector<OnlineKeyframeId> removed_keyframes;
};

// A window without features, sightings and observations: enough for difference() later.
MapWindow outline_of(const MapWindow& window);

// Changes from a window before mapping, or its outline, to the window after.
MapDelta difference(const MapWindow& before, const MapWindow& after);
// Same for a map that has not changed since the window was cut from it. Precondition: all keyframes are online.
MapDelta difference(const MapGraph& before, const MapWindow& after);

// Skips items that the map no longer holds.
void apply(const MapDelta& delta, MapGraph& online);

}  // namespace byre
