#include "byre/optimise/rotation_manifold.h"

#include "byre/geometry/geometry_matchers.h"
#include "byre/optimise/optimise_scene.h"

#include <gtest/gtest.h>

namespace byre {
namespace {

TEST(RotationManifold, MinusUndoesPlus) {
  Draw draw(1);
  for (int i = 0; i < 20; ++i) {
    const Eigen::Quaterniond x = rotation_exp(draw.normal3(1.0));
    const Eigen::Vector3d delta = draw.normal3(0.5);
    Eigen::Quaterniond y;
    Eigen::Vector3d difference;
    RotationManifold().Plus(x.coeffs().data(), delta.data(), y.coeffs().data());
    RotationManifold().Minus(y.coeffs().data(), x.coeffs().data(), difference.data());
    EXPECT_NEAR(y.norm(), 1.0, 1e-15);
    EXPECT_THAT(difference, PointNear(delta, 1e-12));
  }
}

TEST(RotationManifold, AppliesPlusOnTheLeft) {
  const Eigen::Quaterniond x = rotation_exp({0.3, -0.2, 0.5});
  const Eigen::Vector3d delta(0.1, 0.2, -0.3);
  Eigen::Quaterniond y;
  RotationManifold().Plus(x.coeffs().data(), delta.data(), y.coeffs().data());
  EXPECT_LT(angle_between(y, rotation_exp(delta) * x), 1e-12);
}

TEST(RotationManifold, JacobiansOfPlusAndMinusAreInverse) {
  const Eigen::Quaterniond x = Eigen::Quaterniond::Identity();
  Eigen::Matrix<double, 4, 3, Eigen::RowMajor> plus;
  Eigen::Matrix<double, 3, 4, Eigen::RowMajor> minus;
  RotationManifold().PlusJacobian(x.coeffs().data(), plus.data());
  RotationManifold().MinusJacobian(x.coeffs().data(), minus.data());
  EXPECT_TRUE((minus * plus).isIdentity());
}

}  // namespace
}  // namespace byre
