#include "byre/node/stamp_clock.h"

#include <algorithm>

namespace byre {
namespace {

using std::chrono_literals::operator""ms;
using std::chrono_literals::operator""s;

constexpr Timestamp kLeastBackward = 500ms;
constexpr Timestamp kLeastForward = 1s;
constexpr Timestamp kShortest = 1ms;  // between images around a jump

}  // namespace

StampClock::Reading StampClock::read(Timestamp stamp, Timestamp arrival) {
  const Last last = last_.value_or(Last{stamp, arrival});
  last_ = Last{stamp, arrival};
  const Timestamp passed = std::max(arrival - last.arrival, kShortest);
  const Timestamp told = stamp - last.stamp;
  const bool is_backward = told < -kLeastBackward;
  const bool is_forward = told > kLeastForward && told - passed > kLeastForward;
  if (!is_backward && !is_forward) return {stamp - jumped_, std::nullopt};
  const Timestamp jump = told - passed;
  jumped_ += jump;
  return {stamp - jumped_, jump};
}

}  // namespace byre
