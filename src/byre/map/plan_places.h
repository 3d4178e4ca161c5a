#pragma once

#include "byre/map/floor_plan.h"
#include "byre/map/map_file.h"

#include <optional>
#include <string>

namespace byre {

// A place of the map that somebody has recognised, to be found on a floor plan.
struct MapPlace {
  Eigen::Vector3d point_in_map = Eigen::Vector3d::Zero();
  double sigma = 0.0;  // metres along an axis: how well the map knows it; 0 where the map is not in metres
};

// Empty for a point that the map does not have.
std::optional<MapPlace> place_of_point(const StoredMap& stored, PointId id);

// The map point nearest to a pixel, of those that the keyframe sees: a pixel of its left camera's image as recorded,
// distortion and all. How far the pixel is off adds to sigma. Empty where none is seen within 10 pixels, or the map
// does not say with which camera the recording was made.
std::optional<MapPlace> place_at_pixel(const StoredMap& stored, const Keyframe& keyframe, const Eigen::Vector2d& pixel);

// pick_sigma: of x and of y as picked on the plan, metres.
PlanCorrespondence correspondence(std::string name, const MapPlace& place, const Eigen::Vector2d& point_in_plan,
                                  double pick_sigma);

}  // namespace byre
