#pragma once

#include "byre/map/map.h"
#include "byre/trajectory.h"

namespace byre {

// Where the keyframe puts the body.
Pose world_from_body(const Map& map, const Keyframe& keyframe);

// Where the map's keyframes put the body, in order of time; of those with one time the first.
Trajectory keyframe_path(const Map& map);

}  // namespace byre
