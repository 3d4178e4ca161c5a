#pragma once

#include <algorithm>
#include <cmath>

namespace byre {

// How far a step may lead: the larger, the less it is damped. Grows and shrinks as in Ceres (Nielsen 1999).
class TrustRegion {
 public:
  double radius() const { return radius_; }
  // The share is that of the gain expected which there was.
  void widen(double share) {
    radius_ = std::min(1e16, radius_ / std::max(1.0 / 3.0, 1.0 - std::pow(2.0 * share - 1.0, 3)));
    shrink_ = 2.0;
  }
  void narrow() {
    radius_ /= shrink_;
    shrink_ *= 2.0;
  }
  bool is_too_small() const { return radius_ < 1e-32; }

 private:
  double radius_ = 1e4;
  double shrink_ = 2.0;
};

// Ceres' bounds of the diagonal that damping is in proportion to.
inline double bounded(double diagonal) {
  return std::clamp(diagonal, 1e-6, 1e32);
}

}  // namespace byre
