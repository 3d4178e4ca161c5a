#include "byre/odometry/rate_track.h"

#include <algorithm>
#include <chrono>

namespace byre {
namespace {

using namespace std::chrono_literals;

constexpr Timestamp kMaxRateGap = 50ms;

}  // namespace

void RateTrack::add(const AngularRate& sample) {
  if (!samples_.empty() && sample.time <= samples_.back().time) return;
  samples_.push_back(sample);
}

void RateTrack::forget_before(Timestamp time) {
  while (!samples_.empty() && samples_.front().time < time) samples_.pop_front();
}

// Calls add(rate, seconds) for each piece of the time span, with the mean rate between two samples. False if samples do
// not cover the span.
template <typename Add>
bool RateTrack::integrate(Timestamp earlier, Timestamp later, const Add& add) const {
  auto next = std::ranges::upper_bound(samples_, earlier, {}, &AngularRate::time);
  if (next == samples_.begin()) return false;
  Timestamp now = earlier;
  for (auto sample = std::prev(next); now < later; sample = next, ++next) {
    const bool is_last = next == samples_.end();
    if ((is_last ? later : next->time) - sample->time > kMaxRateGap) return false;
    const Timestamp until = is_last ? later : std::min(later, next->time);
    const Eigen::Vector3d rate = is_last ? sample->rate : (0.5 * (sample->rate + next->rate)).eval();
    add(rate, to_seconds(until - now));
    now = until;
    if (is_last) break;
  }
  return true;
}

std::optional<Eigen::Quaterniond> RateTrack::between(Timestamp earlier, Timestamp later,
                                                     const Eigen::Vector3d& bias) const {
  Eigen::Quaterniond turn = Eigen::Quaterniond::Identity();
  const auto add = [&](const Eigen::Vector3d& rate, double seconds) {
    turn = turn * rotation_exp((rate - bias) * seconds);
  };
  return integrate(earlier, later, add) ? std::optional(turn.normalized()) : std::nullopt;
}

std::optional<Eigen::Vector3d> RateTrack::integral(Timestamp earlier, Timestamp later) const {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  const auto add = [&](const Eigen::Vector3d& rate, double seconds) { sum += rate * seconds; };
  return integrate(earlier, later, add) ? std::optional(sum) : std::nullopt;
}

}  // namespace byre
