#pragma once

#include "byre/slam/window.h"

namespace byre {

// Parts of the window that share no points know nothing of each other but what is told of the way between them, and
// that may be known better by now than when they were begun. Moves each, with all it sees, to where the way from the
// part before leads. Where it has one camera, its lengths, and those of the motions, become those of the first part.
// What is not movable stays, and with it what shares points with that, or with the oldest keyframe that has a motion.
// False where no motion leads from one part to another: then nothing is changed.
bool place_parts(MapWindow& window);

}  // namespace byre
