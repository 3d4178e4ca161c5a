#pragma once

#include "byre/pose_hint.h"
#include "byre/ros/messages.h"

#include <optional>

namespace byre {

// What a pose given by hand says, in its own frame: three sigmas of it, but 3 m and 1 rad at least, as a click on a map
// has no height and no exact direction. Without a direction (RViz 2 sends one, other programs leave it zero) any will
// do. Empty without a finite position.
std::optional<PoseHint> hint_of(const ros::PoseWithCovarianceStamped& message);

}  // namespace byre
