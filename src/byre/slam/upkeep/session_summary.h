#pragma once

#include "byre/map/map_graph.h"

namespace byre {

// Removes online keyframes near others until at most max_keyframes are left, at least 0.3 m or 0.3 rad apart, and
// online points that only one of these sees. So the size of a session depends on the places visited, not on time, and
// is bounded.
void thin_out(MapGraph& online, int max_keyframes);

}  // namespace byre
