#pragma once

#include "byre/trajectory.h"

#include <chrono>
#include <functional>
#include <optional>

namespace byre {

// Plays a recording at its own time stamps: its first frame is due when it is first asked for.
class LiveClock {
 public:
  // Waits until the frame of that time is due, or should_stop() holds. Returns by how many seconds it was late when
  // this was called, zero when it had to wait.
  double wait_until_due(Timestamp time, const std::function<bool()>& should_stop);

 private:
  using Clock = std::chrono::steady_clock;
  std::optional<Clock::time_point> time_zero_;  // the wall clock when the recording's own is at zero
};

}  // namespace byre
