#include "byre/geometry/decompositions.h"

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

Eigen::Quaterniond rotation_between(const Eigen::Vector3d& from, const Eigen::Vector3d& to) {
  return Eigen::Quaterniond::FromTwoVectors(from, to);
}

}  // namespace byre
