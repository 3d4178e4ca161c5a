#pragma once

#include "byre/slam/offline_map.h"

#include <vector>

namespace byre {

// A place that looks like another one, as the bays of a barn do.
struct PlaceAlike {
  Eigen::Vector3d shift = Eigen::Vector3d::Zero();  // metres, from the other place to this one
  std::vector<PointId> repeated;                    // points of either place that look alike at this shift, ascending
};

// Places that look like the one at a pose: shifts at which many points that keyframes near the pose saw have points
// that look alike. That with most points first.
std::vector<PlaceAlike> places_alike(const OfflineMap& offline, const Pose& camera_from_place);

}  // namespace byre
