#pragma once

#include "byre/localisation/place_bounds.h"

#include <optional>

namespace byre {

// Where the robot was last trusted to be in the offline map, and what was told since of places that were refused.
class TrustedPlace {
 public:
  explicit TrustedPlace(double max_speed) : max_speed_(max_speed) {}  // metres per second

  void note(const PlaceBefore& place) { place_ = place; }
  void forget() { place_.reset(); }  // it may have been carried since, or was never there

  std::optional<PlaceBounds::Way> way_from_there() const;  // empty where nothing is known

  // Whether it is to be told that a place was refused: once for each reason, until a pose is of use again.
  bool is_news(Doubt refused, Verdict verdict);

 private:
  double max_speed_;  // constant after construction
  std::optional<PlaceBefore> place_;
  Doubt told_ = Doubt::none;
};

}  // namespace byre
