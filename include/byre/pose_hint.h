#pragma once

#include "byre/pose.h"

namespace byre {

// Where somebody who may err says that the robot is.
struct PoseHint {
  Pose map_from_body;
  double radius = 2.0;    // metres by which it may be off
  double turn = 1.0;      // radians by which it may be turned
  double seconds = 10.0;  // time of the frames from now on in which it counts
};

}  // namespace byre
