#pragma once

#include <algorithm>
#include <cmath>

namespace byre {

// Trust region of Levenberg-Marquardt: a larger radius means less damping. Updated as in Ceres (Nielsen 1999).
class TrustRegion {
 public:
  double radius() const { return radius_; }
  // share: actual over expected gain.
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

// Ceres' bounds of the diagonal that scales the damping.
inline double bounded(double diagonal) {
  return std::clamp(diagonal, 1e-6, 1e32);
}

}  // namespace byre
