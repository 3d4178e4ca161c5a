#pragma once

#include "byre/trajectory.h"

#include <cstdint>
#include <optional>

namespace byre {

// Checks the order of the stamps of one sensor.
class StampCheck {
 public:
  enum class Order : std::uint8_t {
    next,      // later than the previous sample
    dropped,   // not later, out of range, or a leap ahead that no second stamp confirms yet
    restarted  // the clock was set back: ten ascending stamps, all earlier than those before
  };
  Order check(Timestamp time);

 private:
  std::optional<Timestamp> last_;
  std::optional<Timestamp> ahead_;  // unconfirmed leap ahead
  std::optional<Timestamp> late_;   // last stamp that was not later than last_
  int late_count_ = 0;              // number of such stamps in a row, ascending
};

}  // namespace byre
