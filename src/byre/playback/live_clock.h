#pragma once

#include "byre/trajectory.h"

#include <chrono>
#include <functional>
#include <optional>

namespace byre {

// Plays a recording in real time, starting at the first call.
class LiveClock {
 public:
  // Waits until the frame of that time is due, or should_stop() is true. Returns the delay at the call in seconds; zero
  // after waiting.
  double wait_until_due(Timestamp time, const std::function<bool()>& should_stop);

 private:
  using Clock = std::chrono::steady_clock;
  std::optional<Clock::time_point> time_zero_;  // wall clock at time zero of the recording
};

}  // namespace byre
