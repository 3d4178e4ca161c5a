#include "byre/pose.h"

#include <cmath>

#include <Eigen/LU>

namespace byre {

Eigen::Quaterniond rotation_exp(const Eigen::Vector3d& rotation_vector) {
  const double angle = rotation_vector.norm();
  // sin(x/2)/x, by its series near zero, where the quotient loses precision.
  const double half_sinc = angle < 1e-4 ? 0.5 - angle * angle / 48.0 : std::sin(0.5 * angle) / angle;
  Eigen::Quaterniond rotation;
  rotation.w() = std::cos(0.5 * angle);
  rotation.vec() = half_sinc * rotation_vector;
  return rotation.normalized();
}

Eigen::Vector3d rotation_log(const Eigen::Quaterniond& rotation) {
  const double sign = rotation.w() < 0.0 ? -1.0 : 1.0;
  const Eigen::Vector3d vector = sign * rotation.vec();
  const double sine = vector.norm();
  if (sine < 1e-9) return 2.0 * vector;
  return vector * (2.0 * std::atan2(sine, sign * rotation.w()) / sine);
}

std::optional<Eigen::Quaterniond> rotation_from_matrix(const Eigen::Matrix3d& matrix) {
  const Eigen::Matrix3d excess = matrix.transpose() * matrix - Eigen::Matrix3d::Identity();
  if (!(excess.cwiseAbs().maxCoeff() < 1e-3) || matrix.determinant() < 0.0) return std::nullopt;
  return Eigen::Quaterniond(matrix).normalized();
}

Eigen::Matrix3d skew(const Eigen::Vector3d& vector) {
  Eigen::Matrix3d matrix;
  matrix << 0.0, -vector.z(), vector.y(), vector.z(), 0.0, -vector.x(), -vector.y(), vector.x(), 0.0;
  return matrix;
}

Pose exp_pose(const Vector6& delta) {
  return {rotation_exp(delta.tail<3>()), delta.head<3>()};
}

Vector6 log_pose(const Pose& pose) {
  Vector6 delta;
  delta << pose.translation, rotation_log(pose.rotation);
  return delta;
}

Matrix6 adjoint(const Pose& a_from_b) {
  const Eigen::Matrix3d rotation = a_from_b.rotation.toRotationMatrix();
  Matrix6 result = Matrix6::Zero();
  result.topLeftCorner<3, 3>() = rotation;
  result.topRightCorner<3, 3>() = skew(a_from_b.translation) * rotation;
  result.bottomRightCorner<3, 3>() = rotation;
  return result;
}

Matrix6 move_covariance(const Matrix6& covariance_in_b, const Pose& a_from_b) {
  const Matrix6 a_motion_from_b_motion = adjoint(a_from_b);
  return a_motion_from_b_motion * covariance_in_b * a_motion_from_b_motion.transpose();
}

double angle_between(const Eigen::Quaterniond& first, const Eigen::Quaterniond& second) {
  return rotation_log(first.conjugate() * second).norm();
}

Pose interpolate(const Pose& first, const Pose& second, double fraction) {
  const Eigen::Vector3d turn = rotation_log(first.rotation.conjugate() * second.rotation);
  return {(first.rotation * rotation_exp(fraction * turn)).normalized(),
          first.translation + fraction * (second.translation - first.translation)};
}

}  // namespace byre
