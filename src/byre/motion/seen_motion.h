#pragma once

#include "byre/trajectory.h"

#include <optional>

namespace byre {

// The body's motion between two frames as it was seen, earlier_from_later, in the lengths that the map has.
struct SeenMotion {
  Timestamp earlier{};
  Timestamp later{};
  Pose body;
  std::optional<Eigen::Vector3d> gyroscope_turn{};  // radians about the gyroscope's axes, bias and all, if it was told
};

}  // namespace byre
