#pragma once

#include "byre/body_motion.h"

#include <deque>
#include <optional>

namespace byre {

// Angular rates of a gyroscope, which it integrates.
class RateTrack {
 public:
  // Samples that are not later than the previous one are dropped.
  void add(const AngularRate& sample);

  void forget_before(Timestamp time);

  bool empty() const { return samples_.empty(); }
  // The gyroscope's rotation, earlier_from_later, by its rates minus a bias. Empty if a gap exceeds 50 ms.
  std::optional<Eigen::Quaterniond> between(Timestamp earlier, Timestamp later, const Eigen::Vector3d& bias) const;

  // Integral of the rates per axis, radians; may exceed half a turn. Empty if between() is empty.
  std::optional<Eigen::Vector3d> integral(Timestamp earlier, Timestamp later) const;

 private:
  template <typename Add>
  bool integrate(Timestamp earlier, Timestamp later, const Add& add) const;

  std::deque<AngularRate> samples_;
};

}  // namespace byre
