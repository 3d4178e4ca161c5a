#include "byre/slam/loops/odometry_lengths.h"

#include "byre/alignment.h"

namespace byre {

void LengthRatio::add(const BodyMotion& measured, const Pose& seen) {
  const Eigen::Vector3d& way = measured.last_from_body.translation;
  const double weight = 1.0 / measured.covariance.topLeftCorner<3, 3>().trace();
  ++count_;
  measured_squared_ += weight * way.squaredNorm();
  visual_by_measured_ += weight * seen.translation.dot(way);
}

std::optional<double> LengthRatio::value() const {
  return visual_by_measured_ > 0.0 ? std::optional(visual_by_measured_ / measured_squared_) : std::nullopt;
}

BodyMotion scale_motion(const BodyMotion& motion, double scale) {
  return {scale_lengths(motion.last_from_body, scale), scale_lengths(motion.covariance, scale)};
}

}  // namespace byre
