#include "byre/trajectory.h"

#include <algorithm>
#include <cmath>

namespace byre {

Timestamp from_seconds(double seconds) {
  return Timestamp(static_cast<Timestamp::rep>(std::llround(seconds * 1e9)));
}

std::optional<Pose> pose_at(const Trajectory& trajectory, Timestamp time, Timestamp max_gap) {
  const auto after = std::ranges::lower_bound(trajectory, time, {}, &StampedPose::time);
  if (after == trajectory.end()) return std::nullopt;
  if (after->time == time) return after->world_from_body;
  if (after == trajectory.begin()) return std::nullopt;
  const auto before = std::prev(after);
  if (after->time - before->time > max_gap) return std::nullopt;
  const double fraction = to_seconds(time - before->time) / to_seconds(after->time - before->time);
  return interpolate(before->world_from_body, after->world_from_body, fraction);
}

}  // namespace byre
