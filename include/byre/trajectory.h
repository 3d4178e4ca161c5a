#pragma once

#include "byre/pose.h"

#include <chrono>
#include <optional>
#include <vector>

namespace byre {

using Timestamp = std::chrono::nanoseconds;  // since the recording's own epoch

inline double to_seconds(Timestamp time) {
  return std::chrono::duration<double>(time).count();
}
Timestamp from_seconds(double seconds);  // rounded to the nearest nanosecond

struct StampedPose {
  Timestamp time{};
  Pose world_from_body;
};

using Trajectory = std::vector<StampedPose>;  // strictly increasing in time

// The pose at a time between two samples at most max_gap apart; empty outside the trajectory or in a larger gap.
std::optional<Pose> pose_at(const Trajectory& trajectory, Timestamp time, Timestamp max_gap);

}  // namespace byre
