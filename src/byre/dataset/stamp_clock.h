#pragma once

#include "byre/trajectory.h"

#include <chrono>
#include <optional>

namespace byre {

// Stamps that go back by no more than this belong to late messages unless more evidence shows that the clock was set.
inline constexpr Timestamp kMostLate = std::chrono::milliseconds(500);
// A clock was set forward where its stamps advance by so much more than the receiver's clock.
inline constexpr Timestamp kLeastForward = std::chrono::seconds(1);

// Whether a stamp that advances by `stamped` while the receiver's clock advances by `received` shows a clock set
// forward.
constexpr bool is_set_forward(Timestamp stamped, Timestamp received) {
  return stamped > kLeastForward && stamped - received > kLeastForward;
}

// Continuous time from stamps of live images whose clock may be set while they arrive. Recordings, whose later stamps
// are known, use restore_times.
class StampClock {
 public:
  struct Reading {
    Timestamp time{};               // stamp less all steps so far
    std::optional<Timestamp> jump;  // step of the clock at this stamp; negative: set back
  };

  // arrival: by a clock that never goes back.
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
