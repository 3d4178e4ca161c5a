#pragma once

#include "byre/slam/window.h"

#include <vector>

namespace byre {

// The id of a point of the online map: a type of its own, so that nothing can name an offline point to change it.
struct OnlinePointId {
  std::uint32_t number = 0;
  operator PointId() const { return {Origin::online, number}; }  // every online point is a point
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
  Sighting sighting;  // names the point; it may be an offline one
};

struct RemovedObservation {
  OnlineKeyframeId keyframe;
  int feature = 0;
  PointId point;  // point that the feature saw; if it sees another by now, that one stays
};

// An offline keyframe is found to see an online point: kept with the point, so that nothing offline changes.
struct NewForeignView {
  OnlinePointId point;
  ForeignView view;
};

struct RemovedForeignView {
  OnlinePointId point;
  Observation observation;  // view of the point that is gone; if it is of another point by now, that one keeps it
};

struct NewPoint {
  MapPoint point;
  std::vector<NewObservation> observations;  // sightings, whose point is set when the new point gets its id
  std::vector<ForeignView> foreign_views;    // foreign views, whose point is set when the new point gets its id
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

// A window without what its keyframes see and who observes its points: enough of it to tell later what has changed.
MapWindow outline_of(const MapWindow& window);

// What mapping has changed between a window as it was cut, or its outline, and as it is now.
MapDelta difference(const MapWindow& before, const MapWindow& after);
// The same, where the map is as it was when the window was cut of it. Precondition: all keyframes are online ones.
MapDelta difference(const Map& before, const MapWindow& after);

// Skips whatever the map no longer holds.
void apply(const MapDelta& delta, Map& online);

}  // namespace byre
