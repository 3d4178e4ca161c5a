#include "byre/optimise/rotation_manifold.h"

#include "byre/pose.h"

namespace byre {

bool RotationManifold::Plus(const double* x, const double* delta, double* x_plus_delta) const {
  const Eigen::Quaterniond moved = rotation_exp(Eigen::Vector3d(delta)) * Eigen::Quaterniond(x);
  Eigen::Map<Eigen::Quaterniond>{x_plus_delta} = moved.normalized();
  return true;
}

bool RotationManifold::PlusJacobian(const double*, double* jacobian) const {
  Eigen::Map<Eigen::Matrix<double, 4, 3, Eigen::RowMajor>>{jacobian}.setIdentity();
  return true;
}

bool RotationManifold::Minus(const double* y, const double* x, double* y_minus_x) const {
  Eigen::Map<Eigen::Vector3d>{y_minus_x} = rotation_log(Eigen::Quaterniond(y) * Eigen::Quaterniond(x).conjugate());
  return true;
}

bool RotationManifold::MinusJacobian(const double*, double* jacobian) const {
  Eigen::Map<Eigen::Matrix<double, 3, 4, Eigen::RowMajor>>{jacobian}.setIdentity();
  return true;
}

}  // namespace byre
