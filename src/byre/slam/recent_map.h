#pragma once

#include "byre/slam/global_mapping.h"
#include "byre/slam/loop_closing.h"

#include <cstdint>
#include <vector>

namespace byre {

// A copy of that part of an online map which came last, from the keyframe of this number on, and of what lies around
// it, to be adjusted without the rest. Movable are the keyframes that came, those that share many points with one of
// them, and those around the ends of these loops. All others that see a point of theirs are anchors, and come first.
// What no movable keyframe sees is left out. Where more than half of all keyframes would be in it, it is the whole map,
// see whole_map; so it is where the number is 0.
MapWindow recent_map(const MapView& map, std::uint32_t first_new, const std::vector<LoopEdge>& loops);

// Metres by which two keyframes lie otherwise to each other than a loop says; 0 where one of them has gone.
double disagreement(const Map& map, const LoopEdge& loop);

// A loop that disagrees by more than this once what lies around it was adjusted bends more than that. In metres.
inline constexpr double kMaxLoopDisagreement = 0.05;

}  // namespace byre
