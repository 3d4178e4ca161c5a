#pragma once

#include "byre/trajectory.h"

#include <chrono>
#include <optional>
#include <vector>

namespace byre {

// Multiple of an interval, rounded to a nanosecond.
Timestamp multiple(double factor, Timestamp interval);

// Median of the positive differences between consecutive stamps; zero without any.
Timestamp typical_interval(const std::vector<Timestamp>& stamps);

// Whether the resolution of the stamps is coarser than their interval: most items have the stamp of a neighbour.
bool is_coarse(const std::vector<Timestamp>& stamps);

// Whether at most a third of the items have the stamp of the item before.
bool are_mostly_distinct(const std::vector<Timestamp>& stamps);

// Whether items of one stamp are received together, because a sender repeats them. Items of a coarse stamp are received
// at the usual rate. False if the numbers of stamps and of receive times differ.
bool are_all_repeated(const std::vector<Timestamp>& stamps, const std::vector<Timestamp>& received);

// Spreads the items of each stamp evenly until the next stamp. The first and the last run may be incomplete.
std::vector<Timestamp> spread_evenly(const std::vector<Timestamp>& stamps);

// Spaces unknown times evenly between known ones; at the usual interval before the first and after the last of them.
void interpolate_gaps(std::vector<Timestamp>& times, const std::vector<bool>& has_time, Timestamp interval);

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
