#pragma once

#include "byre/pose.h"

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace byre {

// Decompositions of small matrices, compiled here once for all: a file in which Eigen's templates for one of them are
// takes seconds longer to compile.

// The eigenvalues and eigenvectors of a symmetric matrix, of which the lower triangle counts.
template <int Size>
struct SymmetricEigen {
  Eigen::Matrix<double, Size, 1> values;      // ascending
  Eigen::Matrix<double, Size, Size> vectors;  // a column for each value, of unit length
};
SymmetricEigen<3> symmetric_eigen(const Eigen::Matrix3d& matrix);
SymmetricEigen<6> symmetric_eigen(const Matrix6& matrix);
Eigen::Vector2d symmetric_eigenvalues(const Eigen::Matrix2d& matrix);
Eigen::Vector3d symmetric_eigenvalues(const Eigen::Matrix3d& matrix);

// matrix = left * values.asDiagonal() * right.transpose(), with left and right orthogonal, values descending and none
// negative.
struct SingularValues {
  Eigen::Matrix3d left;
  Eigen::Vector3d values;
  Eigen::Matrix3d right;
};
SingularValues singular_values(const Eigen::Matrix3d& matrix);

// The rotation R with the largest trace of R^T * matrix: the nearest one, or by Kabsch (1976) the one that brings two
// sets of directions together, of which matrix is the sum of products target * source^T. Never a reflection.
Eigen::Quaterniond nearest_rotation(const Eigen::Matrix3d& matrix);

// The least rotation that takes one direction to the other; of unit length, but for rounding.
Eigen::Quaterniond rotation_between(const Eigen::Vector3d& from, const Eigen::Vector3d& to);

}  // namespace byre
