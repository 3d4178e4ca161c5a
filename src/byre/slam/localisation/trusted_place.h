#pragma once

#include "byre/slam/localisation/place_bounds.h"

#include <optional>

namespace byre {

// The last trusted pose in the offline map, and the rejected places reported since.
class TrustedPlace {
 public:
  explicit TrustedPlace(double max_speed) : max_speed_(max_speed) {}  // metres per second

  void note(const PreviousPlace& place) { place_ = place; }
  void forget() { place_.reset(); }  // the robot may have been carried, or the pose was wrong

  std::optional<PlaceBounds::Reach> reach_from_there() const;  // empty without a trusted pose

  // Whether to report a rejected place: once for each reason, until a pose is not untrusted.
  bool is_new_refusal(DistrustReason refused, Verdict verdict);

 private:
  double max_speed_;  // constant after construction
  std::optional<PreviousPlace> place_;
  DistrustReason reported_ = DistrustReason::none;
};

}  // namespace byre
