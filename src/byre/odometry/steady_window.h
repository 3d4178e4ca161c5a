#pragma once

#include "byre/body_motion.h"

#include <chrono>
#include <deque>
#include <optional>

namespace byre {

// Samples of gyroscope and accelerometer of the last seconds, and whether they are steady. They are steady at rest and
// during even acceleration; the two cannot be distinguished.
class SteadyWindow {
 public:
  static constexpr Timestamp kWindow = std::chrono::milliseconds(800);

  // Samples that are not later than the previous one are dropped.
  void add(const AngularRate& rate);
  void add(const Acceleration& acceleration);
  bool has_accelerations() const { return !accelerations_.empty(); }

  // Means over the window that ends at a time, about the sensor's axes.
  struct Steady {
    Eigen::Vector3d up = Eigen::Vector3d::UnitZ();  // a unit vector; biased during acceleration
    double sigma = 0.0;  // radians, from a consumer sensor's bias and the deviation of samples
    Eigen::Vector3d rate = Eigen::Vector3d::Zero();  // radians per second, with the bias
  };
  // Empty if samples are missing or not steady. Vibration is tolerated, sway is not.
  std::optional<Steady> until(Timestamp time) const;

 private:
  std::deque<AngularRate> rates_;
  std::deque<Acceleration> accelerations_;
};

}  // namespace byre
