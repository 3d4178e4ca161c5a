#pragma once

#include "byre/map/map.h"

namespace byre {

// A copy of a kept map that mapping may change: ids become online ones. Features that see no point are ready to be
// given one again.
Map online_copy(const Map& offline);

}  // namespace byre
