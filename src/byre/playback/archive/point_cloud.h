#pragma once

#include "byre/map/map_graph.h"

#include <cstddef>
#include <vector>

namespace byre {

// Points of a map as a binary PLY file: x, y, z in the map's frame, number of observations, and a colour by that
// number, from blue for one to red for ten or more.
std::vector<std::byte> point_cloud(const MapGraph& map);

}  // namespace byre
