#pragma once

// Matchers that report by how much a pose or point differs.

#include "byre/pose.h"

#include <gmock/gmock.h>

namespace byre {

// A point or pixel within a distance of the expected one, in its own unit.
MATCHER_P2(PointNear, expected, tolerance, "") {
  const double distance = (arg - expected).norm();
  *result_listener << "which is " << distance << " away from " << testing::PrintToString(expected.transpose());
  return distance <= tolerance;
}

// A pose within metres and radians of the expected one.
MATCHER_P3(PoseNear, expected, metres, radians, "") {
  const double distance = (arg.translation - expected.translation).norm();
  const double angle = angle_between(arg.rotation, expected.rotation);
  *result_listener << "which is off by " << distance << " m and " << angle << " rad";
  return distance <= metres && angle <= radians;
}

}  // namespace byre
