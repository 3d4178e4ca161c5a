#pragma once

#include "byre/map/plan/plan_places.h"

#include <optional>
#include <vector>

namespace byre {

// Pictures that show the place near a pixel, at the depth of the map points around it: other keyframes that see these
// points, the best to triangulate by first. The pixels are where they show the place, if the depth is right.
std::vector<KeyframePixel> further_views(const MapGraph& map, const KeyframePixel& pixel);

// Size of the area that a keyframe sees: standard deviation per horizontal axis of its points, geometric mean, in the
// map's unit. Zero with fewer than three points.
double width_of_view(const MapGraph& map, const Keyframe& keyframe, const Eigen::Vector3d& up_in_map);

// The place at which a further pick reduces the uncertainty of a registration most.
struct NextPick {
  Eigen::Vector2d point_in_plan = Eigen::Vector2d::Zero();
  std::vector<KeyframePixel> views;  // two pictures that show it
  double sigma_before = 0.0;         // metres, root mean square of the position sigma along the path
  double sigma_after = 0.0;
};
// pick_sigma: metres, of the further pick. Empty without a point that two keyframes with pictures see.
std::optional<NextPick> next_pick(const MapGraph& map, const DrivingPlane& plane, const PlanRegistration& registration,
                                  double pick_sigma);

}  // namespace byre
