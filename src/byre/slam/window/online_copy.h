#pragma once

#include "byre/map/map_graph.h"

namespace byre {

// Copy of a saved map with online ids, which mapping may change. Features without a point can get one again.
MapGraph online_copy(const MapGraph& offline);

}  // namespace byre
