#include "byre/motion/wheel_track.h"

#include <algorithm>
#include <chrono>

namespace byre {
namespace {

using namespace std::chrono_literals;

constexpr Timestamp kKeptLonger = 120s;
constexpr Timestamp kMaxWheelGap = 500ms;
constexpr Timestamp kMaxAhead = 250ms;

}  // namespace

void WheelTrack::add(const StampedPose& sample) {
  if (!samples_.empty() && sample.time <= samples_.back().time) return;
  samples_.push_back(sample);
}

void WheelTrack::forget_before(Timestamp time) {
  if (samples_.empty() || samples_.front().time + kKeptLonger >= time) return;
  samples_.erase(samples_.begin(), std::ranges::lower_bound(samples_, time, {}, &StampedPose::time));
}

std::optional<Pose> WheelTrack::pose_at(Timestamp time) const {
  if (samples_.size() < 2 || time <= samples_.back().time) return byre::pose_at(samples_, time, kMaxWheelGap);
  const StampedPose &before = samples_[samples_.size() - 2], &last = samples_.back();
  if (time > last.time + kMaxAhead || last.time - before.time > kMaxWheelGap) return {};
  const double fraction = to_seconds(time - before.time) / to_seconds(last.time - before.time);
  return interpolate(before.world_from_body, last.world_from_body, fraction);
}

std::optional<Pose> WheelTrack::between(Timestamp earlier, Timestamp later) const {
  const auto from = pose_at(earlier), to = pose_at(later);
  return from && to ? std::optional(inverse(*from) * *to) : std::nullopt;
}

std::optional<WheelTrack::Distance> WheelTrack::distance(Timestamp earlier, Timestamp later) const {
  const auto from = pose_at(earlier), to = pose_at(later);
  if (!from || !to) return {};
  Distance distance;
  Timestamp time = earlier;
  Pose last = *from;
  const auto go_to = [&](const StampedPose& next) {
    const Pose step = inverse(last) * next.world_from_body;
    distance.metres += step.translation.norm();
    distance.radians += rotation_log(step.rotation).norm();
    time = next.time;
    last = next.world_from_body;
  };
  for (auto sample = std::ranges::upper_bound(samples_, earlier, {}, &StampedPose::time);
       sample != samples_.end() && sample->time < later; ++sample) {
    if (sample->time - time > kMaxWheelGap) return {};
    go_to(*sample);
  }
  if (later - time > kMaxWheelGap) return {};
  go_to({later, *to});
  return distance;
}

}  // namespace byre
