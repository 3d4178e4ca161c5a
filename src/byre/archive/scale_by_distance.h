#pragma once

#include "byre/map/map_file.h"

#include <string>

namespace byre {

// A place of a map as a command line names it: "x,y,z", a position in units of the map; "point:N", a map point by its
// number; or "time:SECONDS", the camera at the keyframe whose time is nearest, which must be within a second.
// Throws InputError naming the text where it is none of these, or where the map holds no such thing.
Eigen::Vector3d find_place(const StoredMap& stored, const std::string& text);

struct ScaledMap {
  StoredMap stored;       // metric
  double factor = 1.0;    // metres of a unit of the map before
  double distance = 0.0;  // between the two places, units of the map before
};

// The map with so many metres between two places. Throws InputError where they are one place, or where the map's rigs
// have a baseline, so that its scale is known.
ScaledMap scale_by_distance(const StoredMap& stored, const std::string& first, const std::string& second,
                            double metres);

}  // namespace byre
