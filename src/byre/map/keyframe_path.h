#pragma once

#include "byre/map/map_graph.h"
#include "byre/trajectory.h"

namespace byre {

Pose world_from_body(const MapGraph& map, const Keyframe& keyframe);

// Body poses at the map's keyframes, by time; of keyframes with equal times the first.
Trajectory keyframe_path(const MapGraph& map);

}  // namespace byre
