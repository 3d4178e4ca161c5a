#pragma once

#include "byre/odometry/visual_motion.h"
#include "byre/odometry/wheel_track.h"

#include <deque>
#include <optional>

#include <Eigen/Core>

namespace byre {

// Delay of wheel stamps against the camera's, seconds: a frame at time t corresponds to wheel samples at t + offset.
// Searches the offset within 0.2 s either way at which turns from images and wheels agree best up to their scale. Empty
// if the turns are too small, or the best offset is at the end of the range. up: the base's axis in the body. known:
// earlier estimate; only its neighbourhood is searched.
std::optional<double> find_time_offset(const std::deque<VisualMotion>& seen, const Eigen::Vector3d& up,
                                       const WheelTrack& wheels, std::optional<double> known = {});

}  // namespace byre
