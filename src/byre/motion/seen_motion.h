#pragma once

#include "byre/trajectory.h"

namespace byre {

// The body's motion between two frames as it was seen, earlier_from_later, in the lengths that the map has.
struct SeenMotion {
  Timestamp earlier{};
  Timestamp later{};
  Pose body;
};

}  // namespace byre
