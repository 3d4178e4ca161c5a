#include "byre/odometry/stamp_check.h"

#include <chrono>

namespace byre {
namespace {

using std::chrono_literals::operator""s;

constexpr Timestamp kLatestStamp = Timestamp::max() / 2;  // differences of stamps stay in range
constexpr Timestamp kLeap = 10s;                          // a larger step ahead needs confirmation by a second stamp
constexpr int kLateUntilRestarted = 10;                   // ascending stamps in a row

}  // namespace

StampCheck::Order StampCheck::check(Timestamp time) {
  if (time > kLatestStamp || time < -kLatestStamp) return Order::dropped;
  if (last_ && time <= *last_) {
    late_count_ = late_ && time > *late_ ? late_count_ + 1 : 1;
    late_ = time;
    if (late_count_ < kLateUntilRestarted) return Order::dropped;
    *this = {};
    last_ = time;
    return Order::restarted;
  }
  late_.reset();
  late_count_ = 0;
  const bool is_confirmed = ahead_ && time > *ahead_ && time - *ahead_ <= kLeap;
  if (last_ && time - *last_ > kLeap && !is_confirmed) {
    ahead_ = time;
    return Order::dropped;
  }
  ahead_.reset();
  last_ = time;
  return Order::next;
}

}  // namespace byre
