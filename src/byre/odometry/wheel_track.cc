#include "byre/odometry/wheel_track.h"

#include <algorithm>
#include <chrono>
#include <cmath>

namespace byre {
namespace {

using namespace std::chrono_literals;

constexpr Timestamp kKeptLonger = 120s;
constexpr Timestamp kMaxWheelGap = 500ms;
constexpr Timestamp kMaxVelocityGap = 300ms;
constexpr Timestamp kMaxAhead = 250ms;
constexpr Timestamp kMaxBehind = 50ms;

// earlier_from_later, along an arc.
Pose arc_of(const BaseTwist& velocity, double seconds) {
  const double half = 0.5 * velocity.wz * seconds;
  const double chord = std::abs(half) > 1e-9 ? std::sin(half) / half : 1.0;  // relative to the arc
  const Eigen::Quaterniond half_turn = rotation_exp({0.0, 0.0, half});
  return {half_turn * half_turn, half_turn * Eigen::Vector3d(velocity.vx, velocity.vy, 0.0) * chord * seconds};
}

BaseTwist mean_of(const BaseTwist& one, const BaseTwist& other) {
  return {other.time, 0.5 * (one.vx + other.vx), 0.5 * (one.vy + other.vy), 0.5 * (one.wz + other.wz)};
}

}  // namespace

void WheelTrack::add(const StampedPose& sample) {
  if (!samples_.empty() && sample.time <= samples_.back().time) return;
  if (velocity_) breaks_.push_back(sample.time);  // velocities have no common frame with poses
  velocity_.reset();
  samples_.push_back(sample);
}

void WheelTrack::begin_segment(const StampedPose& first) {
  if (!samples_.empty() && first.time <= samples_.back().time) return;
  if (!samples_.empty()) breaks_.push_back(first.time);
  velocity_.reset();
  samples_.push_back(first);
}

void WheelTrack::add(const BaseTwist& sample) {
  if (!samples_.empty() && sample.time <= samples_.back().time) return;
  Pose base = samples_.empty() ? Pose{} : samples_.back().world_from_body;
  if (velocity_ && sample.time - velocity_->time <= kMaxVelocityGap) {
    base = base * arc_of(mean_of(*velocity_, sample), to_seconds(sample.time - velocity_->time));
  } else if (!samples_.empty()) {
    breaks_.push_back(sample.time);
  }
  velocity_ = sample;
  samples_.push_back({sample.time, base});
}

// Whether the motion of the base between the two times is unknown.
bool WheelTrack::is_broken(Timestamp earlier, Timestamp later) const {
  const auto next = std::ranges::upper_bound(breaks_, earlier);
  if (next == breaks_.end()) return false;
  const auto broken = std::ranges::lower_bound(samples_, *next, {}, &StampedPose::time);
  return broken == samples_.begin() || later > std::prev(broken)->time;
}

bool WheelTrack::has_jump(Timestamp earlier, Timestamp later) const {
  constexpr Timestamp kLongest = 100ms;
  if (!is_broken(earlier, later)) return false;
  const auto next = std::ranges::upper_bound(breaks_, earlier);
  const auto broken = std::ranges::lower_bound(samples_, *next, {}, &StampedPose::time);
  return broken != samples_.end() && broken != samples_.begin() && broken->time - std::prev(broken)->time <= kLongest;
}

void WheelTrack::forget_before(Timestamp time) {
  if (samples_.empty() || samples_.front().time + kKeptLonger >= time) return;
  samples_.erase(samples_.begin(), std::ranges::lower_bound(samples_, time, {}, &StampedPose::time));
  breaks_.erase(breaks_.begin(), std::ranges::lower_bound(breaks_, time));
}

// The pose before the first sample by the motion after it.
std::optional<Pose> WheelTrack::pose_before_first(Timestamp time) const {
  const StampedPose &first = samples_[0], &second = samples_[1];
  const bool is_motion_known = breaks_.empty() || breaks_.front() > second.time;
  if (!is_motion_known || time < first.time - kMaxBehind || second.time - first.time > kMaxWheelGap) return {};
  const double fraction = to_seconds(time - first.time) / to_seconds(second.time - first.time);
  return interpolate(first.world_from_body, second.world_from_body, fraction);
}

std::optional<Pose> WheelTrack::pose_at(Timestamp time) const {
  if (samples_.size() >= 2 && time < samples_.front().time) return pose_before_first(time);
  if (samples_.size() < 2 || time <= samples_.back().time) return byre::pose_at(samples_, time, kMaxWheelGap);
  const StampedPose &before = samples_[samples_.size() - 2], &last = samples_.back();
  if (velocity_ && time <= last.time + kMaxAhead) {
    return last.world_from_body * arc_of(*velocity_, to_seconds(time - last.time));
  }
  const bool is_segment_open = !breaks_.empty() && breaks_.back() == last.time;  // one pose has no motion
  if (is_segment_open || time > last.time + kMaxAhead || last.time - before.time > kMaxWheelGap) return {};
  const double fraction = to_seconds(time - before.time) / to_seconds(last.time - before.time);
  return interpolate(before.world_from_body, last.world_from_body, fraction);
}

std::optional<Pose> WheelTrack::between(Timestamp earlier, Timestamp later) const {
  if (is_broken(earlier, later)) return {};
  const auto from = pose_at(earlier), to = pose_at(later);
  return from && to ? std::optional(inverse(*from) * *to) : std::nullopt;
}

std::optional<WheelTrack::Distance> WheelTrack::distance(Timestamp earlier, Timestamp later) const {
  if (is_broken(earlier, later)) return {};
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
