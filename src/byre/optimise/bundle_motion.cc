#include "byre/optimise/bundle_motion.h"

#include <cmath>

namespace byre {
namespace {

constexpr double kSquaredWidth = 9.0;  // squared sigmas of all six components together, at which the weight is one half

}  // namespace

MotionError motion_error(const BundleMotion& motion, const Pose& earlier_from_world, const Pose& later_from_world) {
  const Pose seen = later_from_world * inverse(earlier_from_world);
  MotionError error;
  error.residual = log_pose(seen * inverse(motion.later_from_earlier));
  const double squared = error.residual.dot(motion.information * error.residual);
  error.cost = kSquaredWidth * std::log1p(squared / kSquaredWidth);
  error.weight = 1.0 / (1.0 + squared / kSquaredWidth);
  return error;
}

MotionJacobians motion_jacobians(const Pose& earlier_from_world, const Pose& later_from_world) {
  return {-adjoint(later_from_world * inverse(earlier_from_world)), Matrix6::Identity()};
}

Matrix6 to_rotation_translation(const Matrix6& jacobian, const Pose& camera_from_world) {
  Matrix6 result;
  result.leftCols<3>() = jacobian.rightCols<3>() + jacobian.leftCols<3>() * skew(camera_from_world.translation);
  result.rightCols<3>() = jacobian.leftCols<3>();
  return result;
}

}  // namespace byre
