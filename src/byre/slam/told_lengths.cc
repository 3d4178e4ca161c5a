#include "byre/slam/told_lengths.h"

#include "byre/alignment.h"

namespace byre {

void LengthRatio::add(const BodyMotion& told, const Pose& seen) {
  const Eigen::Vector3d& way = told.last_from_body.translation;
  const double weight = 1.0 / told.covariance.topLeftCorner<3, 3>().trace();
  ++count_;
  told_squared_ += weight * way.squaredNorm();
  seen_by_told_ += weight * seen.translation.dot(way);
}

std::optional<double> LengthRatio::value() const {
  return seen_by_told_ > 0.0 ? std::optional(seen_by_told_ / told_squared_) : std::nullopt;
}

BodyMotion scale_motion(const BodyMotion& motion, double scale) {
  return {scale_lengths(motion.last_from_body, scale), scale_lengths(motion.covariance, scale)};
}

}  // namespace byre
