#pragma once

#include "byre/body_motion.h"

#include <optional>

namespace byre {

// How long ways are as they were seen, as a multiple of what is told of them: least squares, each way weighed by the
// covariance of what is told.
class LengthRatio {
 public:
  void add(const BodyMotion& told, const Pose& seen);
  int count() const { return count_; }  // ways
  // Empty where ways were not seen to lead to where they are told to.
  std::optional<double> value() const;

 private:
  int count_ = 0;
  double told_squared_ = 0.0;
  double seen_by_told_ = 0.0;
};

// A motion with all lengths times the scale.
BodyMotion scale_motion(const BodyMotion& motion, double scale);

}  // namespace byre
