#pragma once

#include "byre/benchmark/demo/plan_pane.h"

#include <string>
#include <vector>

namespace byre {

// The demonstration in one picture: the hybrid run on the floor plan, the other arms below it at half the size, each
// with a line of figures, and a legend.
Picture mission_picture(const DemoPlace& place, const std::vector<DemoArm>& arms);

// Heading of an arm in plain words.
std::string plain_name(Arm arm);

// "on the plan after 1.4 s, trusted in 93 % of the frames, ..."
std::string figures_line(const DemoArm& arm);

}  // namespace byre
