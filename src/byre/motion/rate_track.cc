#include "byre/motion/rate_track.h"

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

// Between two samples the rate is the mean of both.
std::optional<Eigen::Quaterniond> RateTrack::between(Timestamp earlier, Timestamp later,
                                                     const Eigen::Vector3d& bias) const {
  auto next = std::upper_bound(samples_.begin(), samples_.end(), earlier,
                               [](Timestamp t, const AngularRate& sample) { return t < sample.time; });
  if (next == samples_.begin()) return {};
  Eigen::Quaterniond turn = Eigen::Quaterniond::Identity();
  Timestamp now = earlier;
  for (auto sample = std::prev(next); now < later; sample = next, ++next) {
    const bool is_last = next == samples_.end();
    if ((is_last ? later : next->time) - sample->time > kMaxRateGap) return {};
    const Timestamp until = is_last ? later : std::min(later, next->time);
    const Eigen::Vector3d rate = is_last ? sample->rate : (0.5 * (sample->rate + next->rate)).eval();
    turn = turn * rotation_exp((rate - bias) * to_seconds(until - now));
    now = until;
    if (is_last) break;
  }
  return turn.normalized();
}

}  // namespace byre
