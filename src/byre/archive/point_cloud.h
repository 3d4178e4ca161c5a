#pragma once

#include "byre/map/map.h"

#include <cstddef>
#include <vector>

namespace byre {

// The points of a map as a binary PLY file: x, y, z in the map's frame, the number of observations, and a colour by
// it: from blue for one to red for ten and more.
std::vector<std::byte> point_cloud(const Map& map);

}  // namespace byre
