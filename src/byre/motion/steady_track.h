#pragma once

#include "byre/body_motion.h"

#include <chrono>
#include <deque>
#include <optional>

namespace byre {

// What gyroscope and accelerometer told over the last seconds, and whether that was steady: a body at rest, or one that
// changes its speed evenly. Which of both, they cannot tell.
class SteadyTrack {
 public:
  static constexpr Timestamp kWindow = std::chrono::milliseconds(800);

  // Samples that are not later than the one before are left out.
  void add(const AngularRate& rate);
  void add(const Acceleration& acceleration);
  bool has_accelerations() const { return !accelerations_.empty(); }

  // The means over the window that ends at a time, about the sensor's axes.
  struct Steady {
    Eigen::Vector3d up = Eigen::Vector3d::UnitZ();   // a unit vector; wrong where the speed changed
    double sigma = 0.0;                              // radians; the bias of a consumer's part, and how steady it was
    Eigen::Vector3d rate = Eigen::Vector3d::Zero();  // radians per second, bias and all
  };
  // Empty where too little was told, and where it was not steady: vibration may be, a body that sways is not.
  std::optional<Steady> until(Timestamp time) const;

 private:
  std::deque<AngularRate> rates_;
  std::deque<Acceleration> accelerations_;
};

}  // namespace byre
