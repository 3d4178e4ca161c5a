#include "byre/pose.h"

#include "byre/geometry/geometry_matchers.h"

#include <cmath>
#include <numbers>
#include <random>

#include <gtest/gtest.h>

namespace byre {
namespace {

constexpr double kPi = std::numbers::pi;

Eigen::Vector3d random_vector(std::mt19937& random, double largest) {
  std::uniform_real_distribution<double> coordinate(-largest, largest);
  const double x = coordinate(random), y = coordinate(random), z = coordinate(random);
  return {x, y, z};
}

Pose random_pose(std::mt19937& random) {
  const Eigen::Vector3d rotation_vector = random_vector(random, 2.0);
  return {rotation_exp(rotation_vector), random_vector(random, 10.0)};
}

Vector6 random_motion(std::mt19937& random, double largest) {
  Vector6 motion;
  motion.head<3>() = random_vector(random, largest);
  motion.tail<3>() = random_vector(random, largest);
  return motion;
}

class PoseLaws : public testing::Test {
 protected:
  std::mt19937 random{1};
  Pose a_from_b = random_pose(random);
  Pose b_from_c = random_pose(random);
  Pose c_from_d = random_pose(random);
};

TEST_F(PoseLaws, CompositionMapsPointsOneAfterTheOther) {
  const Eigen::Vector3d point_in_c = random_vector(random, 5.0);
  EXPECT_THAT((a_from_b * b_from_c) * point_in_c, PointNear(a_from_b * (b_from_c * point_in_c), 1e-12));
}

TEST_F(PoseLaws, CompositionIsAssociative) {
  EXPECT_THAT((a_from_b * b_from_c) * c_from_d, PoseNear(a_from_b * (b_from_c * c_from_d), 1e-12, 1e-12));
}

TEST_F(PoseLaws, InverseUndoesOnEitherSide) {
  EXPECT_THAT(a_from_b * inverse(a_from_b), PoseNear(Pose{}, 1e-12, 1e-12));
  EXPECT_THAT(inverse(a_from_b) * a_from_b, PoseNear(Pose{}, 1e-12, 1e-12));
}

TEST_F(PoseLaws, InverseOfAProductReversesIt) {
  EXPECT_THAT(inverse(a_from_b * b_from_c), PoseNear(inverse(b_from_c) * inverse(a_from_b), 1e-12, 1e-12));
}

TEST_F(PoseLaws, LongChainsStayRotations) {
  Pose chain;
  for (int i = 0; i < 100000; ++i) chain = chain * a_from_b;
  EXPECT_NEAR(chain.rotation.norm(), 1.0, 1e-12);
}

TEST(RotationExp, IsRightHanded) {
  const Eigen::Quaterniond quarter_about_z = rotation_exp({0.0, 0.0, kPi / 2.0});
  EXPECT_THAT(quarter_about_z * Eigen::Vector3d::UnitX(), PointNear(Eigen::Vector3d::UnitY(), 1e-15));
}

class RotationLogOfAngle : public testing::TestWithParam<double> {};

TEST_P(RotationLogOfAngle, InvertsTheExponential) {
  const Eigen::Vector3d rotation_vector = GetParam() * Eigen::Vector3d(1.0, -2.0, 0.5).normalized();
  EXPECT_THAT(rotation_log(rotation_exp(rotation_vector)), PointNear(rotation_vector, 1e-15 + 1e-14 * GetParam()));
}

INSTANTIATE_TEST_SUITE_P(FromNoneToAlmostAHalfTurn, RotationLogOfAngle,
                         testing::Values(0.0, 1e-12, 1e-9, 0.99e-4, 1.01e-4, 0.1, 1.0, 3.0, kPi - 1e-6));

TEST(RotationLog, ReturnsTheShortestRotation) {
  const Eigen::Vector3d axis = Eigen::Vector3d(1.0, 1.0, 0.0).normalized();
  EXPECT_THAT(rotation_log(rotation_exp(1.5 * kPi * axis)), PointNear((-0.5 * kPi * axis).eval(), 1e-14));
}

TEST(RotationLog, IsTheSameForBothSignsOfAQuaternion) {
  const Eigen::Quaterniond rotation = rotation_exp({0.3, -0.4, 0.5});
  const Eigen::Quaterniond negated(-rotation.coeffs());
  EXPECT_THAT(rotation_log(negated), PointNear(rotation_log(rotation), 1e-15));
}

TEST(Skew, IsTheCrossProduct) {
  const Eigen::Vector3d a(1.0, 2.0, 3.0), b(-4.0, 0.5, 2.0);
  EXPECT_THAT(skew(a) * b, PointNear(a.cross(b).eval(), 1e-15));
}

TEST(LogPose, InvertsTheExponential) {
  std::mt19937 random(2);
  for (int i = 0; i < 20; ++i) {
    const Vector6 motion = random_motion(random, 1.5);
    EXPECT_THAT(log_pose(exp_pose(motion)), PointNear(motion, 1e-13));
  }
}

TEST(ExpPose, KeepsTranslationAndRotationApart) {
  Vector6 motion;
  motion << 1.0, 2.0, 3.0, 0.1, 0.2, 0.3;
  EXPECT_THAT(exp_pose(motion).translation, PointNear(Eigen::Vector3d(1.0, 2.0, 3.0), 0.0));
}

TEST(Adjoint, TransformsASmallMotionToFirstOrder) {
  std::mt19937 random(3);
  for (int i = 0; i < 20; ++i) {
    const Pose a_from_b = random_pose(random);
    const Vector6 motion_in_b = random_motion(random, 1e-6);
    const Vector6 motion_in_a = adjoint(a_from_b) * motion_in_b;
    EXPECT_THAT(exp_pose(motion_in_a) * a_from_b, PoseNear(a_from_b * exp_pose(motion_in_b), 1e-10, 1e-10));
  }
}

TEST(Adjoint, OfAProductIsTheProductOfAdjoints) {
  std::mt19937 random(4);
  const Pose a_from_b = random_pose(random), b_from_c = random_pose(random);
  const Matrix6 difference = adjoint(a_from_b * b_from_c) - adjoint(a_from_b) * adjoint(b_from_c);
  EXPECT_LT(difference.norm(), 1e-12);
}

TEST(AngleBetween, IsTheRotationBetweenTwoPoses) {
  const Eigen::Quaterniond first = rotation_exp({0.7, 0.1, -0.3});
  const Eigen::Quaterniond second = first * rotation_exp({0.0, 0.25, 0.0});
  EXPECT_NEAR(angle_between(first, second), 0.25, 1e-14);
  EXPECT_NEAR(angle_between(second, first), 0.25, 1e-14);
}

TEST(Interpolate, ReturnsTheEndpoints) {
  std::mt19937 random(5);
  const Pose first = random_pose(random), second = random_pose(random);
  EXPECT_THAT(interpolate(first, second, 0.0), PoseNear(first, 1e-14, 1e-14));
  EXPECT_THAT(interpolate(first, second, 1.0), PoseNear(second, 1e-14, 1e-14));
}

TEST(Interpolate, RotatesUniformlyAndExtrapolates) {
  const Pose first{rotation_exp({0.0, 0.0, 0.2}), {1.0, 0.0, 0.0}};
  const Pose second{rotation_exp({0.0, 0.0, 0.6}), {3.0, 0.0, 4.0}};
  EXPECT_THAT(interpolate(first, second, 0.25),
              PoseNear(Pose{rotation_exp({0.0, 0.0, 0.3}), {1.5, 0.0, 1.0}}, 1e-14, 1e-14));
  EXPECT_THAT(interpolate(first, second, 2.0),
              PoseNear(Pose{rotation_exp({0.0, 0.0, 1.0}), {5.0, 0.0, 8.0}}, 1e-14, 1e-14));
}

TEST(RotationFromMatrix, AcceptsOnlyRoundedRotations) {
  const Eigen::Matrix3d turn = Eigen::AngleAxisd(2.0, Eigen::Vector3d(1.0, 2.0, 3.0).normalized()).toRotationMatrix();
  const Eigen::Matrix3d rounded = (turn * 1e4).array().round() / 1e4;
  ASSERT_TRUE(rotation_from_matrix(rounded).has_value());
  EXPECT_LT(angle_between(*rotation_from_matrix(rounded), Eigen::Quaterniond(turn)), 1e-4);
  EXPECT_FALSE(rotation_from_matrix(1.01 * turn).has_value());
  EXPECT_FALSE(rotation_from_matrix(-turn).has_value());
  EXPECT_FALSE(rotation_from_matrix(Eigen::Matrix3d::Zero()).has_value());
}

}  // namespace
}  // namespace byre
