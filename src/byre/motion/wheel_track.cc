#include "byre/motion/wheel_track.h"

#include <algorithm>
#include <chrono>

namespace byre {
namespace {

using namespace std::chrono_literals;

constexpr Timestamp kKept = 120s;
constexpr Timestamp kMaxGap = 500ms;
constexpr Timestamp kMaxAhead = 100ms;  // how far the last motion is taken to go on

}  // namespace

void WheelTrack::add(const StampedPose& sample) {
  if (!samples_.empty() && sample.time <= samples_.back().time) return;
  samples_.push_back(sample);
  while (samples_.front().time + kKept < sample.time) samples_.pop_front();
}

std::optional<Pose> WheelTrack::pose_at(Timestamp time) const {
  if (samples_.size() < 2 || time < samples_.front().time || time > samples_.back().time + kMaxAhead) return {};
  auto after = std::lower_bound(samples_.begin(), samples_.end(), time,
                                [](const StampedPose& sample, Timestamp t) { return sample.time < t; });
  if (after == samples_.begin()) return after->world_from_body;
  if (after == samples_.end()) --after;
  const auto before = std::prev(after);
  if (after->time - before->time > kMaxGap) return {};
  const double fraction = to_seconds(time - before->time) / to_seconds(after->time - before->time);
  return interpolate(before->world_from_body, after->world_from_body, fraction);
}

std::optional<Pose> WheelTrack::between(Timestamp earlier, Timestamp later) const {
  const auto from = pose_at(earlier), to = pose_at(later);
  return from && to ? std::optional(inverse(*from) * *to) : std::nullopt;
}

}  // namespace byre
