#include "byre/geometry/triangulation.h"

#include "byre/geometry/geometry_matchers.h"

#include <cmath>
#include <random>

#include <gtest/gtest.h>

namespace byre {
namespace {

using testing::Eq;
using testing::Optional;

constexpr double kMinAngle = 0.01;  // radians

const Pose kSecondFromFirst{rotation_exp({0.05, -0.1, 0.02}), {-0.5, 0.05, 0.1}};

TEST(Triangulate, IsExactOnCleanRays) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> side(-2.0, 2.0), depth(2.0, 8.0);
  for (int i = 0; i < 100; ++i) {
    const double x = side(random), y = side(random), z = depth(random);
    const Eigen::Vector3d point_in_first(x, y, z);
    EXPECT_THAT(triangulate(point_in_first, kSecondFromFirst * point_in_first, kSecondFromFirst, kMinAngle),
                Optional(PointNear(point_in_first, 1e-11)));
  }
}

TEST(Triangulate, AcceptsBearingsOfAnyLength) {
  const Eigen::Vector3d point_in_first(0.4, -0.3, 3.0);
  const Eigen::Vector3d point_in_second = kSecondFromFirst * point_in_first;
  EXPECT_THAT(triangulate(0.01 * point_in_first, 70.0 * point_in_second, kSecondFromFirst, kMinAngle),
              Optional(PointNear(point_in_first, 1e-12)));
}

TEST(Triangulate, IsIndependentOfTheOrderOfCameras) {
  const Eigen::Vector3d point_in_first(0.4, -0.3, 3.0);
  const Eigen::Vector3d noisy_in_second = kSecondFromFirst * point_in_first + Eigen::Vector3d(0.004, 0.01, 0.0);
  const auto point = triangulate(point_in_first, noisy_in_second, kSecondFromFirst, kMinAngle);
  const auto swapped = triangulate(noisy_in_second, point_in_first, inverse(kSecondFromFirst), kMinAngle);
  ASSERT_TRUE(point.has_value());
  EXPECT_THAT(swapped, Optional(PointNear((kSecondFromFirst * *point).eval(), 1e-12)));
}

TEST(Triangulate, StaysWithinAFewSigmasOfTheTruth) {
  std::mt19937 random(2);
  std::normal_distribution<double> noise(0.0, 1e-3);  // ray noise at z = 1, about half a pixel
  const Eigen::Vector3d point_in_first(0.3, 0.2, 4.0);
  const Eigen::Vector3d point_in_second = kSecondFromFirst * point_in_first;
  const double parallax = 0.5 / 4.0;
  const double depth_sigma = std::sqrt(2.0) * 1e-3 * 4.0 / parallax;
  for (int i = 0; i < 100; ++i) {
    Eigen::Vector3d first = point_in_first / point_in_first.z();
    Eigen::Vector3d second = point_in_second / point_in_second.z();
    first += Eigen::Vector3d(noise(random), noise(random), 0.0);
    second += Eigen::Vector3d(noise(random), noise(random), 0.0);
    EXPECT_THAT(triangulate(first, second, kSecondFromFirst, kMinAngle),
                Optional(PointNear(point_in_first, 5.0 * depth_sigma)));
  }
}

TEST(Triangulate, WeightsTheNearerCameraMore) {
  // The rays pass each other 0.1 m apart in y; the second camera is four times nearer.
  const Pose second_from_first{Eigen::Quaterniond::Identity(), {-3.0, -0.1, -3.0}};
  const Eigen::Vector3d along_first(0.75, 0.0, 1.0), along_second(0.0, 0.0, 1.0);
  const auto point = triangulate(along_first, along_second, second_from_first, kMinAngle);
  ASSERT_TRUE(point.has_value());
  EXPECT_GT(point->y(), 0.05);
  EXPECT_LT(point->y(), 0.1);
}

TEST(Triangulate, IsEmptyBehindTheCameras) {
  const Eigen::Vector3d behind_first(0.4, -0.3, -3.0);
  EXPECT_THAT(triangulate(-behind_first, -(kSecondFromFirst * behind_first), kSecondFromFirst, kMinAngle),
              Eq(std::nullopt));
  EXPECT_THAT(triangulate(-behind_first, kSecondFromFirst * behind_first, kSecondFromFirst, kMinAngle),
              Eq(std::nullopt));
}

TEST(Triangulate, IsEmptyBelowTheSmallestAngle) {
  const Pose second_from_first{Eigen::Quaterniond::Identity(), {-1.0, 0.0, 0.0}};
  const Eigen::Vector3d point_in_first(0.5, 0.0, 50.0);  // parallax of 0.02 radians
  const Eigen::Vector3d point_in_second = second_from_first * point_in_first;
  EXPECT_TRUE(triangulate(point_in_first, point_in_second, second_from_first, 0.0199).has_value());
  EXPECT_FALSE(triangulate(point_in_first, point_in_second, second_from_first, 0.0201).has_value());
}

TEST(Triangulate, IsEmptyForParallelAndOpposedRays) {
  const Eigen::Vector3d ahead(0.0, 0.0, 1.0);
  const Pose beside{Eigen::Quaterniond::Identity(), {-1.0, 0.0, 0.0}};
  const Pose opposite{rotation_exp({0.0, 3.14159265, 0.0}), {0.0, 0.0, 2.0}};
  EXPECT_FALSE(triangulate(ahead, ahead, beside, 0.0).has_value());
  EXPECT_FALSE(triangulate(ahead, ahead, opposite, kMinAngle).has_value());
}

TEST(Triangulate, IsEmptyWithoutABaseline) {
  const Pose turned{rotation_exp({0.0, 0.1, 0.0}), Eigen::Vector3d::Zero()};
  EXPECT_FALSE(triangulate({0.1, 0.0, 1.0}, {0.1, 0.0, 1.0}, turned, 0.0).has_value());
}

}  // namespace
}  // namespace byre
