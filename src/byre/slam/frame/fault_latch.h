#pragma once

#include "byre/trajectory.h"

#include <cstdint>
#include <optional>

namespace byre {

// Evidence of one frame for the cause of a doubt. unclear: the frame cannot show whether the cause is present.
enum class Sign : std::uint8_t { unclear, absent, present };

inline Sign sign_of(bool is_present) {
  return is_present ? Sign::present : Sign::absent;
}

// A doubt that lasts as long as its cause. The first present sign raises it. It ends after kLeastFrames absent signs
// that cover kLeastSeconds more than the present ones did, at most kMostSeconds. Unclear signs do not change it.
class FaultLatch {
 public:
  static constexpr double kLeastSeconds = 1.0;
  static constexpr double kMostSeconds = 10.0;
  static constexpr int kLeastFrames = 10;

  // Precondition: times do not descend.
  void note(Timestamp time, Sign sign);
  bool is_raised() const { return seconds_to_go_ > 0.0 || frames_to_go_ > 0; }

 private:
  std::optional<Timestamp> last_;
  double seconds_to_go_ = 0.0;  // seconds of absent signs until it ends
  int frames_to_go_ = 0;        // absent signs until it ends
};

}  // namespace byre
