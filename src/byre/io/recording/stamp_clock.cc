#include "byre/io/recording/stamp_clock.h"

#include <algorithm>

namespace byre {

StampClock::Reading StampClock::read(Timestamp stamp, Timestamp arrival) {
  constexpr Timestamp kShortest = std::chrono::milliseconds(1);  // least time between the images around a step
  const Last last = last_.value_or(Last{stamp, arrival});
  last_ = Last{stamp, arrival};
  const Timestamp received = std::max(arrival - last.arrival, kShortest);
  const Timestamp stamped = stamp - last.stamp;
  if (stamped >= -kMaxLateness && !is_set_forward(stamped, received)) return {stamp - jumped_, std::nullopt};
  const Timestamp jump = stamped - received;
  jumped_ += jump;
  return {stamp - jumped_, jump};
}

}  // namespace byre
