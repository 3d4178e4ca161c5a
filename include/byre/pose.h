#pragma once

#include <optional>

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace byre {

using Vector6 = Eigen::Matrix<double, 6, 1>;
using Matrix6 = Eigen::Matrix<double, 6, 6>;

// Rigid transform, always named a_from_b: point_in_a = a_from_b * point_in_b. Metres.
struct Pose {
  Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();
  Eigen::Vector3d translation = Eigen::Vector3d::Zero();

  bool operator==(const Pose& other) const {
    return rotation.coeffs() == other.rotation.coeffs() && translation == other.translation;
  }
};

inline Eigen::Vector3d operator*(const Pose& a_from_b, const Eigen::Vector3d& point_in_b) {
  return a_from_b.rotation * point_in_b + a_from_b.translation;
}

inline Pose operator*(const Pose& a_from_b, const Pose& b_from_c) {
  return {(a_from_b.rotation * b_from_c.rotation).normalized(), a_from_b * b_from_c.translation};
}

inline Pose inverse(const Pose& a_from_b) {
  const Eigen::Quaterniond b_from_a = a_from_b.rotation.conjugate();
  return {b_from_a, -(b_from_a * a_from_b.translation)};
}

// Rotation vector (axis times angle, radians) to unit quaternion and back; the logarithm's angle is at most pi.
Eigen::Quaterniond rotation_exp(const Eigen::Vector3d& rotation_vector);
Eigen::Vector3d rotation_log(const Eigen::Quaterniond& rotation);

// A rotation matrix as written in a file, its rounding errors removed; empty when it is none (to 1e-3 an entry of
// R^T R), or mirrors.
std::optional<Eigen::Quaterniond> rotation_from_matrix(const Eigen::Matrix3d& matrix);

// The cross-product matrix: skew(a) * b = a x b.
Eigen::Matrix3d skew(const Eigen::Vector3d& vector);

// A small motion is (translation in metres, rotation vector in radians), in that order, throughout byre.
// exp_pose(delta) * a_from_b moves the pose by delta as seen in frame a; a_from_b * exp_pose(delta) as seen in b.
// Translation and rotation are decoupled: R = exp(rotation), t = translation.
Pose exp_pose(const Vector6& delta);
Vector6 log_pose(const Pose& pose);

// Moves a small motion (and, as A * covariance * A^T, its covariance) from frame b to frame a:
// a_from_b * exp_pose(delta) = exp_pose(adjoint(a_from_b) * delta) * a_from_b to first order.
Matrix6 adjoint(const Pose& a_from_b);

// The covariance of a small motion as seen in frame a, given it as seen in frame b.
Matrix6 move_covariance(const Matrix6& covariance_in_b, const Pose& a_from_b);

// Angle between two rotations, radians, 0 to pi.
double angle_between(const Eigen::Quaterniond& first, const Eigen::Quaterniond& second);

// Straight-line and slerp interpolation; fraction 0 gives first, 1 gives second, values beyond extrapolate.
Pose interpolate(const Pose& first, const Pose& second, double fraction);

}  // namespace byre
