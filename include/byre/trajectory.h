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

// Pose of the body in the world, by time.
struct StampedPose {
  Timestamp time{};
  Pose world_from_body;
};

using Trajectory = std::vector<StampedPose>;  // strictly increasing in time

// Interpolated pose, between samples at most max_gap apart. Empty outside the trajectory and in larger gaps.
std::optional<Pose> pose_at(const Trajectory& trajectory, Timestamp time, Timestamp max_gap);

}  // namespace byre
