#pragma once

#include "byre/map/map_file.h"

#include <string>

namespace byre {

// Position in a map from a command line argument: "x,y,z" in units of the map; "point:N", a map point by number; or
// "time:SECONDS", the camera at the nearest keyframe, at most one second away. Throws InputError naming the text if it
// is none of these or does not exist in the map.
Eigen::Vector3d find_place(const StoredMap& stored, const std::string& text);

struct ScaledMap {
  StoredMap stored;       // metric
  double factor = 1.0;    // metres per unit of the map before
  double distance = 0.0;  // between the two places, units of the map before
};

// The map scaled so that the distance between two positions is `metres`. Throws InputError if the positions coincide,
// or if the map's rigs have a baseline, which determines the scale.
ScaledMap scale_by_distance(const StoredMap& stored, const std::string& first, const std::string& second,
                            double metres);

}  // namespace byre
