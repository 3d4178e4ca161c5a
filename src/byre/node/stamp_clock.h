#pragma once

#include "byre/trajectory.h"

#include <optional>

namespace byre {

// Makes a time that never jumps of the stamps of images, as clocks of robots are set while they run, and recordings
// begin again. Stamps that go back a little are left as they are: such images came in the wrong order.
class StampClock {
 public:
  struct Reading {
    Timestamp time{};               // stamp, without the jumps so far
    std::optional<Timestamp> jump;  // how far the stamp is from where it was to be, where that is a jump
  };

  // arrival: by a clock that never goes back.
  Reading read(Timestamp stamp, Timestamp arrival);

  // A stamp of another sensor by the same clock, without the jumps so far.
  Timestamp without_jumps(Timestamp stamp) const { return stamp - jumped_; }

 private:
  struct Last {
    Timestamp stamp{};
    Timestamp arrival{};
  };
  std::optional<Last> last_;
  Timestamp jumped_{};  // all jumps together
};

}  // namespace byre
