#pragma once

#include "byre/slam/window/window.h"

namespace byre {

// Places parts of the window that share no points by the measured motion between them, which may be more precise now
// than at their beginning. Each part moves, with its points, to the pose predicted from the part before. Monocular
// parts and the motions are scaled to the first part. Fixed keyframes do not move, nor parts that share points with
// them or with the oldest keyframe that has a motion. False, and nothing changes, if no motion connects two parts.
bool place_parts(MapWindow& window);

}  // namespace byre
