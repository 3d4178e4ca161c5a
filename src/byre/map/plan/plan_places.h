#pragma once

#include "byre/map/map_file.h"
#include "byre/map/plan/floor_plan.h"

#include <optional>
#include <string>

namespace byre {

// A position in the map that was recognised, to be located on a floor plan.
struct MapPosition {
  Eigen::Vector3d point_in_map = Eigen::Vector3d::Zero();
  double sigma = 0.0;  // metres per axis, of the map's position; 0 in a map without metric scale
};

// Empty if the point does not exist.
std::optional<MapPosition> position_of_point(const StoredMap& stored, PointId id);

// The map point observed by the keyframe nearest to a pixel of its left camera's original image. The distance in pixels
// adds to sigma. Empty without a point within 10 pixels, or if the map does not contain the recording's camera.
std::optional<MapPosition> position_at_pixel(const StoredMap& stored, const Keyframe& keyframe,
                                             const Eigen::Vector2d& pixel);

// pick_sigma: of x and of y on the plan, metres.
PlanCorrespondence correspondence(std::string name, const MapPosition& place, const Eigen::Vector2d& point_in_plan,
                                  double pick_sigma);

}  // namespace byre
