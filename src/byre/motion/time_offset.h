#pragma once

#include "byre/motion/seen_motion.h"
#include "byre/motion/wheel_track.h"

#include <deque>
#include <optional>

#include <Eigen/Core>

namespace byre {

// By how much wheels stamp later than the camera, seconds: a frame at time t shows what they tell of t + offset. The
// offset, of a fifth of a second at most either way, under which turns seen and turns told agree best. Empty where too
// little was turned, or the best lies at the end of that fifth. up: the base's axis, as the body has it. known: what
// was found before; then only its surroundings are tried.
std::optional<double> find_time_offset(const std::deque<SeenMotion>& seen, const Eigen::Vector3d& up,
                                       const WheelTrack& wheels, std::optional<double> known = {});

}  // namespace byre
