#pragma once

#include "byre/body_motion.h"

#include <optional>

namespace byre {

// Scale of visual motion relative to measured motion: least squares, weighted by the covariance of the measured motion.
class LengthRatio {
 public:
  void add(const BodyMotion& measured, const Pose& seen);
  int count() const { return count_; }  // number of motions
  // Empty if visual and measured motions have opposite directions.
  std::optional<double> value() const;

 private:
  int count_ = 0;
  double measured_squared_ = 0.0;
  double visual_by_measured_ = 0.0;
};

BodyMotion scale_motion(const BodyMotion& motion, double scale);

}  // namespace byre
