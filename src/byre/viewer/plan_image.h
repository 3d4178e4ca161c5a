#pragma once

#include "byre/floor_plan.h"

#include <string>

namespace byre {

// The image of a plan as a PNG file, whatever it was; no side longer than max_side pixels, so that any browser can draw
// it. Throws InputError when it cannot be read.
std::string plan_png(const FloorPlan& plan, int max_side = 4096);

}  // namespace byre
