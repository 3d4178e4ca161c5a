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

// Conversion between rotation vector (axis times angle, radians) and unit quaternion. The logarithm's angle is at most
// pi.
Eigen::Quaterniond rotation_exp(const Eigen::Vector3d& rotation_vector);
Eigen::Vector3d rotation_log(const Eigen::Quaterniond& rotation);

// Rotation of a matrix read from a file, without its rounding errors. Empty if R^T R differs from identity by more than
// 1e-3 in an entry, or if the matrix is a reflection.
std::optional<Eigen::Quaterniond> rotation_from_matrix(const Eigen::Matrix3d& matrix);

// Cross-product matrix: skew(a) * b = a x b.
Eigen::Matrix3d skew(const Eigen::Vector3d& vector);

// Small motions are (translation in metres, rotation vector in radians), in this order, throughout byre.
// exp_pose(delta) * a_from_b moves the pose by delta in frame a, a_from_b * exp_pose(delta) in frame b. Translation and
// rotation are decoupled: R = exp(rotation), t = translation; this is not the exponential map of SE(3).
Pose exp_pose(const Vector6& delta);
Vector6 log_pose(const Pose& pose);

// Matrix A that transforms a small motion from frame b to frame a, and its covariance as A * covariance * A^T:
// a_from_b * exp_pose(delta) = exp_pose(A * delta) * a_from_b to first order.
Matrix6 adjoint(const Pose& a_from_b);

// Covariance of a small motion in frame a, given its covariance in frame b.
Matrix6 move_covariance(const Matrix6& covariance_in_b, const Pose& a_from_b);

// Variances of a small motion, sums over the axes: square metres, square radians.
inline double position_variance(const Matrix6& covariance) {
  return covariance.topLeftCorner<3, 3>().trace();
}

inline double rotation_variance(const Matrix6& covariance) {
  return covariance.bottomRightCorner<3, 3>().trace();
}

// Angle between two rotations, radians, 0 to pi.
double angle_between(const Eigen::Quaterniond& first, const Eigen::Quaterniond& second);

// Linear and slerp interpolation: fraction 0 yields first, 1 yields second, values beyond extrapolate.
Pose interpolate(const Pose& first, const Pose& second, double fraction);

}  // namespace byre
