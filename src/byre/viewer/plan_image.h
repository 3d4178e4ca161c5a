#pragma once

#include "byre/floor_plan.h"

#include <string>

namespace byre {

// Plan image as PNG, reduced to max_side pixels for browsers. Throws InputError if it cannot be read.
std::string plan_png(const FloorPlan& plan, int max_side = 4096);

}  // namespace byre
