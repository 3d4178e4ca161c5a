#pragma once

#include "byre/trajectory.h"

#include <chrono>
#include <optional>

namespace byre {

// Stamps that go back by at most this time are of late messages, unless other evidence shows a step of the clock.
inline constexpr Timestamp kMaxLateness = std::chrono::milliseconds(500);
// A clock was set forward if its stamps advance by this time more than the receiver's clock.
inline constexpr Timestamp kMinForwardStep = std::chrono::seconds(1);

// Whether a clock was set forward, if its stamps advance by `stamped` while the receiver's clock advances by
// `received`.
constexpr bool is_set_forward(Timestamp stamped, Timestamp received) {
  return stamped > kMinForwardStep && stamped - received > kMinForwardStep;
}

// Continuous time from stamps of live images, whose clock may be set meanwhile. For recordings, where later stamps are
// available, see restore_times.
class StampClock {
 public:
  struct Reading {
    Timestamp time{};               // stamp minus all steps so far
    std::optional<Timestamp> jump;  // step of the clock at this stamp; negative: set back
  };

  // arrival: by a steady clock.
  Reading read(Timestamp stamp, Timestamp arrival);

  // Time of a stamp that another sensor took from the same clock.
  Timestamp without_jumps(Timestamp stamp) const { return stamp - jumped_; }

 private:
  struct Last {
    Timestamp stamp{};
    Timestamp arrival{};
  };
  std::optional<Last> last_;
  Timestamp jumped_{};  // sum of all steps
};

}  // namespace byre
