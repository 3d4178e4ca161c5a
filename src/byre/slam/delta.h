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
  PointId point;  // that it saw; if it sees another by now, that one stays
};

struct NewPoint {
  MapPoint point;
  std::vector<NewObservation> observations;  // their sightings' points are set when the point gets its id
};

// All that mapping may write. Names only online things, so an offline map cannot change.
struct MapDelta {
  std::vector<MovedKeyframe> moved_keyframes;
  std::vector<UpdatedPoint> updated_points;
  std::vector<OnlinePointId> removed_points;
  std::vector<RemovedObservation> removed_observations;
  std::vector<NewObservation> new_observations;
  std::vector<NewPoint> new_points;
  std::vector<OnlineKeyframeId> removed_keyframes;
};

// What mapping has changed between a window as it was cut and as it is now.
MapDelta difference(const MapWindow& before, const MapWindow& after);

// Skips whatever the map no longer holds.
void apply(const MapDelta& delta, Map& online);

}  // namespace byre
