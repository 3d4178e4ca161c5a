#include "byre/alignment.h"

#include "byre/geometry/geometry_matchers.h"

#include <random>
#include <vector>

#include <gtest/gtest.h>

namespace byre {
namespace {

using Points = std::vector<Eigen::Vector3d>;

Points scattered(int count, std::uint32_t seed, const Eigen::Vector3d& extent = {5.0, 4.0, 2.0}) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> coordinate(-1.0, 1.0);
  Points points(static_cast<std::size_t>(count));
  for (Eigen::Vector3d& point : points) {
    for (int axis = 0; axis < 3; ++axis) point[axis] = 7.0 + extent[axis] * coordinate(random);
  }
  return points;
}

Points mapped(const Similarity& target_from_source, const Points& points, double sigma = 0.0) {
  std::mt19937 random(99);
  std::normal_distribution<double> noise(0.0, 1.0);
  Points result;
  for (const Eigen::Vector3d& point : points) {
    const double x = noise(random), y = noise(random), z = noise(random);
    result.push_back(target_from_source * point + sigma * Eigen::Vector3d(x, y, z));
  }
  return result;
}

double sum_of_squares(const Similarity& target_from_source, const Points& source, const Points& target) {
  double sum = 0.0;
  for (std::size_t i = 0; i < source.size(); ++i) sum += (target[i] - target_from_source * source[i]).squaredNorm();
  return sum;
}

Similarity truth(double scale) {
  return {scale, {rotation_exp({0.4, -1.1, 2.0}), {3.0, -20.0, 1.5}}};
}

TEST(Align, IsExactOnCleanPoints) {
  const Points source = scattered(20, 1);
  const auto found = align(source, mapped(truth(1.0), source), Scale::fixed);
  ASSERT_TRUE(found.has_value());
  EXPECT_EQ(found->scale, 1.0);
  EXPECT_THAT(found->target_from_source, PoseNear(truth(1.0).target_from_source, 1e-12, 1e-13));
}

TEST(Align, EstimatesTheScaleIfFree) {
  const Points source = scattered(20, 2);
  const auto found = align(source, mapped(truth(0.37), source), Scale::free);
  ASSERT_TRUE(found.has_value());
  EXPECT_NEAR(found->scale, 0.37, 1e-13);
  EXPECT_THAT(found->target_from_source, PoseNear(truth(0.37).target_from_source, 1e-12, 1e-13));
}

TEST(Align, NeedsOnlyThreePoints) {
  const Points source = scattered(3, 3);
  const auto found = align(source, mapped(truth(2.0), source), Scale::free);
  ASSERT_TRUE(found.has_value());
  EXPECT_THAT(found->target_from_source, PoseNear(truth(2.0).target_from_source, 1e-11, 1e-12));
}

TEST(Align, ReturnsARotationInsteadOfAReflection) {
  const Points source = scattered(20, 4);
  Points mirrored = source;
  for (Eigen::Vector3d& point : mirrored) point.z() = -point.z();
  const auto found = align(source, mirrored, Scale::fixed);
  ASSERT_TRUE(found.has_value());
  EXPECT_NEAR(found->target_from_source.rotation.toRotationMatrix().determinant(), 1.0, 1e-12);
}

TEST(Align, AveragesNoise) {
  const Points source = scattered(1000, 5);
  const auto found = align(source, mapped(truth(1.5), source, 0.05), Scale::free);
  ASSERT_TRUE(found.has_value());
  // Expected error: sigma / sqrt(count), for the translation times the distance of the points from the origin.
  EXPECT_NEAR(found->scale, 1.5, 3e-3);
  EXPECT_THAT(found->target_from_source, PoseNear(truth(1.5).target_from_source, 0.03, 2e-3));
}

TEST(Align, IsTheLeastSquaresMinimum) {
  const Points source = scattered(30, 6);
  const Points target = mapped(truth(1.5), source, 0.3);
  const auto found = align(source, target, Scale::free);
  ASSERT_TRUE(found.has_value());
  const double least = sum_of_squares(*found, source, target);
  for (int i = 0; i < 6; ++i) {
    for (const double step : {-1e-3, 1e-3}) {
      Similarity moved = *found;
      moved.target_from_source = exp_pose(step * Vector6::Unit(i)) * moved.target_from_source;
      EXPECT_GT(sum_of_squares(moved, source, target), least);
    }
  }
  for (const double factor : {0.999, 1.001}) {
    Similarity scaled = *found;
    scaled.scale *= factor;
    EXPECT_GT(sum_of_squares(scaled, source, target), least);
  }
}

TEST(Align, DeterminesARotationFromPlanarPoints) {
  const Points source = scattered(20, 7, {5.0, 4.0, 0.0});
  const auto found = align(source, mapped(truth(1.0), source), Scale::fixed);
  ASSERT_TRUE(found.has_value());
  EXPECT_THAT(found->target_from_source, PoseNear(truth(1.0).target_from_source, 1e-12, 1e-13));
}

TEST(Align, IsEmptyForCollinearPoints) {
  const Points source = scattered(20, 8, {5.0, 0.0, 0.0});
  EXPECT_FALSE(align(source, mapped(truth(1.0), source), Scale::fixed).has_value());
}

TEST(Align, IsEmptyForCoincidentPoints) {
  const Points source(10, Eigen::Vector3d(1.0, 2.0, 3.0));
  EXPECT_FALSE(align(source, source, Scale::free).has_value());
}

TEST(Align, IsEmptyWithFewerThanThreePoints) {
  const Points source = scattered(2, 9);
  EXPECT_FALSE(align(source, source, Scale::fixed).has_value());
  EXPECT_FALSE(align({}, {}, Scale::fixed).has_value());
}

TEST(MoveCamera, KeepsTheImageAndScalesDepths) {
  const Similarity target_from_source = truth(1.7);
  const Pose camera_from_source{rotation_exp({0.1, 0.2, -0.3}), {0.4, -1.0, 2.0}};
  const Pose camera_from_target = move_camera(target_from_source, camera_from_source);
  for (const Eigen::Vector3d& point_in_source : scattered(10, 3)) {
    const Eigen::Vector3d seen = camera_from_target * (target_from_source * point_in_source);
    EXPECT_THAT(seen, PointNear(1.7 * (camera_from_source * point_in_source), 1e-12));
  }
}

TEST(ScaleLengths, KeepsRotationsOfACovariance) {
  Vector6 sigmas;
  sigmas << 1.0, 2.0, 3.0, 4.0, 5.0, 6.0;
  const Matrix6 covariance = sigmas * sigmas.transpose();
  sigmas.head<3>() *= 2.5;
  EXPECT_LT((scale_lengths(covariance, 2.5) - sigmas * sigmas.transpose()).norm(), 1e-12);
}

}  // namespace
}  // namespace byre
