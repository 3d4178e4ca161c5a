#pragma once

#include "byre/body_motion.h"

#include <deque>
#include <optional>

namespace byre {

// What a gyroscope tells.
class RateTrack {
 public:
  // Samples that are not later than the one before are left out.
  void add(const AngularRate& sample);

  void forget_before(Timestamp time);

  bool empty() const { return samples_.empty(); }
  // The gyroscope's turn, earlier_from_later, by its rates less a bias; empty where a twentieth of a second is not
  // covered.
  std::optional<Eigen::Quaterniond> between(Timestamp earlier, Timestamp later, const Eigen::Vector3d& bias) const;

  // Integral of the rates by axis, radians; may exceed half a turn. Empty where between() is empty.
  std::optional<Eigen::Vector3d> integral(Timestamp earlier, Timestamp later) const;

 private:
  template <typename Add>
  bool integrate(Timestamp earlier, Timestamp later, const Add& add) const;

  std::deque<AngularRate> samples_;
};

}  // namespace byre
