#pragma once

#include "byre/slam/loops/global_mapping.h"
#include "byre/slam/loops/loop_closing.h"

#include <cstdint>
#include <vector>

namespace byre {

// Copy of the newest part of an online map, from keyframe number first_new on, and of its surroundings, to be adjusted
// without the rest. Movable are the new keyframes, those that share many points with one of them, and those around the
// ends of these loops. Other keyframes that see their points are anchors, and come first. Points that no movable
// keyframe sees are left out. The result is the whole map, see whole_map, if it would have more than half of all
// keyframes, or if first_new is 0.
MapWindow recent_map(const MapView& map, std::uint32_t first_new, const std::vector<LoopEdge>& loops);

// Distance between the relative position of two keyframes and that measured by a loop, metres; 0 if one was removed.
double disagreement(const MapGraph& map, const LoopEdge& loop);

// Disagreement of a loop after the map around it was adjusted, above which the whole map is corrected, metres.
inline constexpr double kMaxLoopDisagreement = 0.05;

}  // namespace byre
