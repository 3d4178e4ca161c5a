#include "byre/geometry/decompositions.h"

#include <cmath>
#include <numbers>

#include <Eigen/Eigenvalues>
#include <Eigen/SVD>

namespace byre {
namespace {

template <int Size>
SymmetricEigen<Size> eigen_of(const Eigen::Matrix<double, Size, Size>& matrix) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix<double, Size, Size>> solver(matrix);
  return {solver.eigenvalues(), solver.eigenvectors()};
}

template <int Size>
Eigen::Matrix<double, Size, 1> eigenvalues_of(const Eigen::Matrix<double, Size, Size>& matrix) {
  return Eigen::SelfAdjointEigenSolver<Eigen::Matrix<double, Size, Size>>(matrix, Eigen::EigenvaluesOnly).eigenvalues();
}

}  // namespace

SymmetricEigen<3> symmetric_eigen(const Eigen::Matrix3d& matrix) {
  return eigen_of<3>(matrix);
}

SymmetricEigen<6> symmetric_eigen(const Matrix6& matrix) {
  return eigen_of<6>(matrix);
}

Eigen::Vector2d symmetric_eigenvalues(const Eigen::Matrix2d& matrix) {
  return eigenvalues_of<2>(matrix);
}

Eigen::Vector3d symmetric_eigenvalues(const Eigen::Matrix3d& matrix) {
  return eigenvalues_of<3>(matrix);
}

SingularValues singular_values(const Eigen::Matrix3d& matrix) {
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(matrix, Eigen::ComputeFullU | Eigen::ComputeFullV);
  return {svd.matrixU(), svd.singularValues(), svd.matrixV()};
}

Eigen::Quaterniond nearest_rotation(const Eigen::Matrix3d& matrix) {
  const auto [left, values, right] = singular_values(matrix);
  const Eigen::Vector3d signs(1.0, 1.0, left.determinant() * right.determinant() < 0.0 ? -1.0 : 1.0);
  return Eigen::Quaterniond(Eigen::Matrix3d(left * signs.asDiagonal() * right.transpose()));
}

// Like Eigen's FromTwoVectors, but without its matrix decomposition for opposite directions.
Eigen::Quaterniond rotation_between(const Eigen::Vector3d& from, const Eigen::Vector3d& to) {
  constexpr double kOpposite = 1e-12;
  const Eigen::Vector3d first = from.normalized(), second = to.normalized();
  const double cosine = second.dot(first);
  if (cosine < kOpposite - 1.0) {
    return Eigen::Quaterniond(Eigen::AngleAxisd(std::numbers::pi, first.unitOrthogonal()));
  }
  const double twice_cosine_of_half = std::sqrt((1.0 + cosine) * 2.0);
  const Eigen::Vector3d axis = first.cross(second) * (1.0 / twice_cosine_of_half);
  return {0.5 * twice_cosine_of_half, axis.x(), axis.y(), axis.z()};
}

}  // namespace byre
