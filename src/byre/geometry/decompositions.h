#pragma once

#include "byre/pose.h"

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace byre {

// Decompositions of small matrices, compiled once: Eigen's templates for each add seconds to a file's compilation.

// Eigenvalues and eigenvectors of a symmetric matrix; only its lower triangle is read.
template <int Size>
struct SymmetricEigen {
  Eigen::Matrix<double, Size, 1> values;      // ascending
  Eigen::Matrix<double, Size, Size> vectors;  // unit columns, one per value
};
SymmetricEigen<3> symmetric_eigen(const Eigen::Matrix3d& matrix);
SymmetricEigen<6> symmetric_eigen(const Matrix6& matrix);
Eigen::Vector2d symmetric_eigenvalues(const Eigen::Matrix2d& matrix);
Eigen::Vector3d symmetric_eigenvalues(const Eigen::Matrix3d& matrix);

// matrix = left * values.asDiagonal() * right.transpose(): left, right orthogonal, values descending, non-negative.
struct SingularValues {
  Eigen::Matrix3d left;
  Eigen::Vector3d values;
  Eigen::Matrix3d right;
};
SingularValues singular_values(const Eigen::Matrix3d& matrix);

// The rotation R with the largest trace of R^T * matrix: the nearest rotation, or the alignment of two sets of
// directions if matrix is the sum of target * source^T (Kabsch 1976). Never a reflection.
Eigen::Quaterniond nearest_rotation(const Eigen::Matrix3d& matrix);

// The smallest rotation from one direction to the other; of unit length up to rounding.
Eigen::Quaterniond rotation_between(const Eigen::Vector3d& from, const Eigen::Vector3d& to);

}  // namespace byre
