#include "byre/slam/frame/fault_latch.h"

#include <algorithm>

namespace byre {

void FaultLatch::note(Timestamp time, Sign sign) {
  constexpr double kLongestStep = 0.5;  // seconds, maximum that one frame counts for, also after a gap
  const double seconds = last_ ? std::clamp(to_seconds(time - *last_), 0.0, kLongestStep) : 0.0;
  last_ = time;
  if (sign == Sign::present) {
    seconds_to_go_ = std::clamp(seconds_to_go_ + seconds, kLeastSeconds, kMostSeconds);
    frames_to_go_ = kLeastFrames;
  } else if (sign == Sign::absent) {
    seconds_to_go_ = std::max(0.0, seconds_to_go_ - seconds);
    frames_to_go_ = std::max(0, frames_to_go_ - 1);
  }
}

}  // namespace byre
