#pragma once

#include "byre/pose.h"

namespace byre {

// Approximate pose of the robot, given by an operator.
struct PoseHint {
  Pose map_from_body;
  double radius = 2.0;    // largest position error, metres
  double turn = 1.0;      // largest rotation error, radians
  double seconds = 10.0;  // lifetime from the next frame on, seconds of frame time
};

}  // namespace byre
