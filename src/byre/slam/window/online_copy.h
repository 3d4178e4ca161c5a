#pragma once

#include "byre/map/map.h"

namespace byre {

// Copy of a saved map with online ids, which mapping may change. Features without a point can get one again.
Map online_copy(const Map& offline);

}  // namespace byre
