#include "byre/playback/live_clock.h"

#include <algorithm>
#include <thread>

namespace byre {

double LiveClock::wait_until_due(Timestamp time, const std::function<bool()>& should_stop) {
  constexpr auto kStopInterval = std::chrono::milliseconds(50);
  const Clock::time_point called = Clock::now();
  if (!time_zero_) time_zero_ = called - time;
  const Clock::time_point due = *time_zero_ + time;
  for (Clock::time_point now = called; now < due && !should_stop(); now = Clock::now()) {
    std::this_thread::sleep_until(std::min<Clock::time_point>(due, now + kStopInterval));
  }
  return std::max(0.0, std::chrono::duration<double>(called - due).count());
}

}  // namespace byre
