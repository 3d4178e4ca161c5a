#include "byre/geometry/absolute_pose.h"

#include "byre/geometry/geometry_matchers.h"

#include <algorithm>
#include <random>

#include <gtest/gtest.h>

namespace byre {
namespace {

using Sightings = std::vector<PointSighting>;

const Rig kRig{
    .width = 752, .height = 480, .focal = 450.0, .cx = 376.0, .cy = 240.0, .baseline = 0.11, .body_from_camera = {}};
const Pose kCameraFromWorld{rotation_exp({0.3, -1.2, 0.5}), {4.0, -2.0, 1.0}};

Eigen::Vector2d random_pixel(std::mt19937& random) {
  std::uniform_real_distribution<double> column(0.0, kRig.width - 1.0), row(0.0, kRig.height - 1.0);
  const double u = column(random), v = row(random);
  return {u, v};
}

// Sightings of random points with noise of sigma pixels; those before first_inlier have random pixels.
Sightings seen(int count, int first_inlier, double sigma, std::uint32_t seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> depth(1.0, 6.0);
  std::normal_distribution<double> noise(0.0, 1.0);
  Sightings sightings;
  for (int i = 0; i < count; ++i) {
    const Eigen::Vector2d pixel = random_pixel(random);
    const Eigen::Vector3d point_in_camera = depth(random) * kRig.ray(pixel);
    const double du = noise(random), dv = noise(random);
    const Eigen::Vector2d observed = i < first_inlier ? random_pixel(random) : pixel + sigma * Eigen::Vector2d(du, dv);
    sightings.push_back({inverse(kCameraFromWorld) * point_in_camera, observed});
  }
  return sightings;
}

Sightings seen_exactly(const std::vector<Eigen::Vector3d>& points_in_camera) {
  Sightings sightings;
  for (const Eigen::Vector3d& point : points_in_camera) {
    sightings.push_back({inverse(kCameraFromWorld) * point, kRig.project(point).head<2>()});
  }
  return sightings;
}

double sum_of_squares(const Pose& camera_from_world, const Sightings& sightings, const std::vector<bool>& chosen) {
  double sum = 0.0;
  for (std::size_t i = 0; i < sightings.size(); ++i) {
    const Eigen::Vector3d point_in_camera = camera_from_world * sightings[i].point_in_world;
    if (chosen[i]) sum += (kRig.project(point_in_camera).head<2>() - sightings[i].pixel).squaredNorm();
  }
  return sum;
}

TEST(EstimateAbsolutePose, IsExactOnCleanSightings) {
  const auto found = estimate_absolute_pose(seen(50, 0, 0.0, 1), kRig, {});
  ASSERT_TRUE(found.has_value());
  EXPECT_THAT(found->camera_from_world, PoseNear(kCameraFromWorld, 1e-9, 1e-9));
  EXPECT_EQ(found->inlier_count, 50);
}

TEST(EstimateAbsolutePose, FindsThePoseFromFourSightings) {
  const auto found = estimate_absolute_pose(seen(4, 0, 0.0, 2), kRig, {});
  ASSERT_TRUE(found.has_value());
  EXPECT_THAT(found->camera_from_world, PoseNear(kCameraFromWorld, 1e-8, 1e-8));
}

TEST(EstimateAbsolutePose, AveragesNoise) {
  const auto found = estimate_absolute_pose(seen(200, 0, 1.0, 3), kRig, {});
  ASSERT_TRUE(found.has_value());
  EXPECT_THAT(found->camera_from_world, PoseNear(kCameraFromWorld, 0.005, 0.002));
  EXPECT_GT(found->inlier_count, 195);
}

TEST(EstimateAbsolutePose, IsRobustToHalfOutliers) {
  for (std::uint32_t seed = 10; seed < 30; ++seed) {
    const auto found = estimate_absolute_pose(seen(200, 100, 1.0, seed), kRig, {});
    ASSERT_TRUE(found.has_value());
    EXPECT_THAT(found->camera_from_world, PoseNear(kCameraFromWorld, 0.01, 0.004)) << "seed " << seed;
    EXPECT_GT(std::count(found->inliers.begin() + 100, found->inliers.end(), true), 95);
    EXPECT_LT(std::count(found->inliers.begin(), found->inliers.begin() + 100, true), 5);
  }
}

TEST(EstimateAbsolutePose, IsRobustToFourInFiveOutliers) {
  const auto found = estimate_absolute_pose(seen(200, 160, 0.5, 40), kRig, {});
  ASSERT_TRUE(found.has_value());
  EXPECT_THAT(found->camera_from_world, PoseNear(kCameraFromWorld, 0.02, 0.006));
}

TEST(EstimateAbsolutePose, RejectsInconsistentDisparities) {
  Sightings sightings = seen(60, 0, 0.0, 7);
  for (std::size_t i = 0; i < sightings.size(); ++i) {
    const double disparity = kRig.project(kCameraFromWorld * sightings[i].point_in_world).z();
    sightings[i].disparity = i < 20 ? disparity + 30.0 : disparity;
  }
  const auto found = estimate_absolute_pose(sightings, kRig, {});
  ASSERT_TRUE(found.has_value());
  EXPECT_EQ(found->inlier_count, 40);
  EXPECT_THAT(found->camera_from_world, PoseNear(kCameraFromWorld, 1e-9, 1e-9));
}

TEST(EstimateAbsolutePose, CountsItsInliers) {
  const Sightings sightings = seen(100, 30, 1.0, 4);
  const auto found = estimate_absolute_pose(sightings, kRig, {});
  ASSERT_TRUE(found.has_value());
  EXPECT_EQ(found->inliers.size(), sightings.size());
  EXPECT_EQ(std::count(found->inliers.begin(), found->inliers.end(), true), found->inlier_count);
}

TEST(EstimateAbsolutePose, MinimisesTheErrorOfItsInliers) {
  const Sightings sightings = seen(100, 30, 1.0, 5);
  const auto found = estimate_absolute_pose(sightings, kRig, {});
  ASSERT_TRUE(found.has_value());
  const double least = sum_of_squares(found->camera_from_world, sightings, found->inliers);
  for (int i = 0; i < 6; ++i) {
    for (const double step : {-1e-4, 1e-4}) {
      const Pose moved = exp_pose(step * Vector6::Unit(i)) * found->camera_from_world;
      EXPECT_GT(sum_of_squares(moved, sightings, found->inliers), least);
    }
  }
}

TEST(EstimateAbsolutePose, IsDeterministicForASeed) {
  const Sightings sightings = seen(100, 60, 1.0, 6);
  const auto first = estimate_absolute_pose(sightings, kRig, {.seed = 3});
  const auto second = estimate_absolute_pose(sightings, kRig, {.seed = 3});
  ASSERT_TRUE(first.has_value() && second.has_value());
  EXPECT_EQ(first->camera_from_world.rotation.coeffs(), second->camera_from_world.rotation.coeffs());
  EXPECT_EQ(first->camera_from_world.translation, second->camera_from_world.translation);
  EXPECT_EQ(first->inliers, second->inliers);
}

TEST(EstimateAbsolutePose, AcceptsPlanarPoints) {
  std::mt19937 random(7);
  std::vector<Eigen::Vector3d> wall;
  for (int i = 0; i < 30; ++i) {
    const Eigen::Vector3d ray = kRig.ray(random_pixel(random));
    wall.push_back(ray * (3.0 / (1.0 + 0.4 * ray.x())));  // z + 0.4 x = 3
  }
  const auto found = estimate_absolute_pose(seen_exactly(wall), kRig, {});
  ASSERT_TRUE(found.has_value());
  EXPECT_THAT(found->camera_from_world, PoseNear(kCameraFromWorld, 1e-8, 1e-8));
}

TEST(EstimateAbsolutePose, NeverCountsAPointBehindTheCamera) {
  Sightings sightings = seen(30, 0, 0.0, 8);
  const Eigen::Vector3d behind(0.2, 0.1, -2.0);
  sightings.push_back({inverse(kCameraFromWorld) * behind, kRig.project(behind).head<2>()});
  const auto found = estimate_absolute_pose(sightings, kRig, {});
  ASSERT_TRUE(found.has_value());
  EXPECT_FALSE(found->inliers.back());
}

TEST(EstimateAbsolutePose, IsEmptyWithFewerThanFourSightings) {
  EXPECT_FALSE(estimate_absolute_pose(seen(3, 0, 0.0, 9), kRig, {}).has_value());
  EXPECT_FALSE(estimate_absolute_pose({}, kRig, {}).has_value());
}

TEST(EstimateAbsolutePose, IsEmptyWithoutFourConsistentSightings) {
  EXPECT_FALSE(estimate_absolute_pose(seen(6, 6, 0.0, 50), kRig, {.max_error = 0.01}).has_value());
}

TEST(EstimateAbsolutePose, IsEmptyForCollinearPoints) {
  std::vector<Eigen::Vector3d> edge;
  for (int i = 0; i < 20; ++i) edge.emplace_back(-1.0 + 0.1 * i, 0.3, 3.0 + 0.05 * i);
  EXPECT_FALSE(estimate_absolute_pose(seen_exactly(edge), kRig, {}).has_value());
}

TEST(EstimateAbsolutePose, IsEmptyForNearlyCollinearPoints) {
  std::mt19937 random(11);
  std::uniform_real_distribution<double> off(-2e-4, 2e-4);
  std::vector<Eigen::Vector3d> edge;
  for (int i = 0; i < 20; ++i) edge.emplace_back(-1.0 + 0.1 * i, 0.3 + off(random), 3.0 + off(random));
  EXPECT_FALSE(estimate_absolute_pose(seen_exactly(edge), kRig, {}).has_value());
}

TEST(EstimateAbsolutePose, IsEmptyForCoincidentPoints) {
  const std::vector<Eigen::Vector3d> same(10, Eigen::Vector3d(0.1, 0.2, 3.0));
  EXPECT_FALSE(estimate_absolute_pose(seen_exactly(same), kRig, {}).has_value());
}

}  // namespace
}  // namespace byre
