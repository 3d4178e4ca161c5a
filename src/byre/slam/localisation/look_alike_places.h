#pragma once

#include "byre/slam/places/offline_map.h"

#include <span>
#include <vector>

namespace byre {

// A place that looks like another one, such as the next bay of a barn.
struct LookAlikePlace {
  Eigen::Vector3d shift = Eigen::Vector3d::Zero();  // metres, from the other place to this one
  // Points of both places that look alike at this shift, ascending.
  std::vector<PointId> repeated;
};

// Places that look like the one at a pose: shifts at which many points seen by keyframes near the pose have look-alike
// points. Most points first.
std::vector<LookAlikePlace> look_alike_places(const OfflineMap& offline, const Pose& camera_from_place);

// Adds places at other shifts, up to six in all; opposite shifts are the same.
void add_look_alikes(std::span<const LookAlikePlace> more, std::vector<LookAlikePlace>& places);

}  // namespace byre
