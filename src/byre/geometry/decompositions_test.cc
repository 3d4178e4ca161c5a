#include "byre/geometry/decompositions.h"

#include <gtest/gtest.h>

namespace byre {
namespace {

TEST(Decompositions, ReproduceTheMatrix) {
  const Eigen::Matrix3d any{{1.0, 2.0, -3.0}, {0.5, -1.0, 4.0}, {2.0, 0.0, 1.0}};
  const SingularValues singular = singular_values(any);
  EXPECT_TRUE((singular.left * singular.values.asDiagonal() * singular.right.transpose()).isApprox(any, 1e-12));
  EXPECT_GE(singular.values[0], singular.values[1]);
  EXPECT_GE(singular.values[1], singular.values[2]);

  const Eigen::Matrix3d symmetric = any + any.transpose();
  const SymmetricEigen<3> eigen = symmetric_eigen(symmetric);
  EXPECT_TRUE((eigen.vectors * eigen.values.asDiagonal() * eigen.vectors.transpose()).isApprox(symmetric, 1e-12));
  EXPECT_LE(eigen.values[0], eigen.values[1]);
  EXPECT_TRUE(symmetric_eigenvalues(symmetric).isApprox(eigen.values, 1e-12));

  const Matrix6 large = Matrix6::NullaryExpr([](Eigen::Index i, Eigen::Index j) { return 1.0 / (1.0 + i + j); });
  const SymmetricEigen<6> hilbert = symmetric_eigen(large);
  EXPECT_TRUE((hilbert.vectors * hilbert.values.asDiagonal() * hilbert.vectors.transpose()).isApprox(large, 1e-12));
}

TEST(Decompositions, ReadTheLowerTriangleOfSymmetricMatrices) {
  EXPECT_TRUE(symmetric_eigenvalues(Eigen::Matrix2d{{2.0, 99.0}, {0.0, 1.0}}).isApprox(Eigen::Vector2d(1.0, 2.0)));
}

TEST(Decompositions, ReturnTheNearestRotationWithoutReflection) {
  const Eigen::Quaterniond turn(Eigen::AngleAxisd(0.7, Eigen::Vector3d(1.0, 2.0, 3.0).normalized()));
  const Eigen::Matrix3d stretched = turn * Eigen::Vector3d(3.0, 2.0, 0.5).asDiagonal();
  EXPECT_TRUE(nearest_rotation(stretched).isApprox(turn, 1e-12));
  const Eigen::Matrix3d reflected = turn * Eigen::Vector3d(3.0, 2.0, -0.5).asDiagonal();
  EXPECT_TRUE(nearest_rotation(reflected).isApprox(turn, 1e-12));
}

TEST(Decompositions, RotateBetweenTwoDirectionsIncludingOpposites) {
  const Eigen::Vector3d from(1.0, 2.0, 3.0);
  for (const Eigen::Vector3d& to : {Eigen::Vector3d(-2.0, 0.1, 1.0), from, Eigen::Vector3d(-from)}) {
    EXPECT_TRUE((rotation_between(from, to) * from.normalized()).isApprox(to.normalized(), 1e-12)) << to.transpose();
  }
}

}  // namespace
}  // namespace byre
