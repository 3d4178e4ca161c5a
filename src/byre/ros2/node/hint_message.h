#pragma once

#include "byre/io/ros/messages.h"
#include "byre/pose_hint.h"

#include <optional>

namespace byre {

// Hint from a pose set by hand, in the frame of the message. Radius and turn are three sigmas, but at least 3 m and
// 1 rad, because a click on a map is imprecise. A zero quaternion permits any direction, as some programs other than
// RViz 2 send none. Empty without a finite position.
std::optional<PoseHint> hint_of(const ros::PoseWithCovarianceStamped& message);

}  // namespace byre
