#include "byre/geometry/essential.h"

#include "byre/geometry/geometry_matchers.h"
#include "byre/geometry/two_view_scene.h"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include <Eigen/SVD>

namespace byre {
namespace {

using ::testing::Contains;

std::array<TwoViewMatch, 5> five_matches(const Pose& motion, const DepthOf& depth_of, std::uint32_t seed) {
  const auto matches = matches_of(motion, depth_of, {.count = 5, .seed = seed});
  std::array<TwoViewMatch, 5> five;
  std::copy(matches.begin(), matches.end(), five.begin());
  return five;
}

// Distance up to scale and sign.
double distance_between(const Eigen::Matrix3d& first, const Eigen::Matrix3d& second) {
  const Eigen::Matrix3d a = first.normalized(), b = second.normalized();
  return std::min((a - b).norm(), (a + b).norm());
}

double distance_to_nearest(const std::vector<Eigen::Matrix3d>& candidates, const Eigen::Matrix3d& truth) {
  double nearest = 2.0;
  for (const Eigen::Matrix3d& candidate : candidates) nearest = std::min(nearest, distance_between(candidate, truth));
  return nearest;
}

TEST(FivePointEssentials, IncludeTheTrueMatrix) {
  for (std::uint32_t seed = 1; seed <= 50; ++seed) {
    const Pose motion = sideways_motion(0.4);
    const auto essentials = five_point_essentials(five_matches(motion, room_depth, seed));
    EXPECT_LT(distance_to_nearest(essentials, essential_of(motion)), 1e-5) << "seed " << seed;
  }
}

TEST(FivePointEssentials, IncludeTheTrueMatrixForAForwardMotion) {
  const Pose motion{rotation_exp({0.01, 0.02, 0.0}), {0.02, 0.0, -1.0}};
  for (std::uint32_t seed = 1; seed <= 20; ++seed) {
    const auto essentials = five_point_essentials(five_matches(motion, room_depth, seed));
    EXPECT_LT(distance_to_nearest(essentials, essential_of(motion)), 1e-5) << "seed " << seed;
  }
}

TEST(FivePointEssentials, IncludeTheTrueMatrixForAPlane) {
  for (std::uint32_t seed = 1; seed <= 20; ++seed) {
    const Pose motion = sideways_motion(0.4);
    const auto essentials = five_point_essentials(five_matches(motion, wall_depth, seed));
    EXPECT_LT(distance_to_nearest(essentials, essential_of(motion)), 1e-4) << "seed " << seed;
  }
}

TEST(FivePointEssentials, AreEssentialAndFitTheirMatches) {
  const auto matches = five_matches(sideways_motion(0.4), room_depth, 7);
  const auto essentials = five_point_essentials(matches);
  ASSERT_FALSE(essentials.empty());
  EXPECT_LE(essentials.size(), 10u);
  for (const Eigen::Matrix3d& essential : essentials) {
    const Eigen::Vector3d values = Eigen::JacobiSVD<Eigen::Matrix3d>(essential).singularValues();
    EXPECT_NEAR(values[0], values[1], 1e-6);
    EXPECT_NEAR(values[2], 0.0, 1e-6);
    for (const TwoViewMatch& match : matches) {
      EXPECT_NEAR(match.ray_in_second.dot(essential * match.ray_in_first), 0.0, 1e-9);
    }
  }
}

TEST(FivePointEssentials, AreFiniteForCoincidentMatches) {
  std::array<TwoViewMatch, 5> same;
  same.fill({{0.1, 0.2, 1.0}, {0.15, 0.2, 1.0}, 1e-3});
  for (const Eigen::Matrix3d& essential : five_point_essentials(same)) EXPECT_TRUE(essential.allFinite());
}

TEST(EssentialOf, VanishesOnMatchesOfTheMotion) {
  const Pose motion = sideways_motion(0.3);
  for (const TwoViewMatch& match : matches_of(motion, room_depth, {.count = 20})) {
    EXPECT_NEAR(match.ray_in_second.dot(essential_of(motion) * match.ray_in_first), 0.0, 1e-12);
  }
}

TEST(MotionsFromEssential, IncludeTheTrueMotion) {
  Pose motion = sideways_motion(1.0);
  const auto motions = motions_from_essential(essential_of(motion));
  EXPECT_THAT(motions, Contains(PoseNear(motion, 1e-9, 1e-7)));
}

TEST(MotionsFromEssential, AreRigidAndReproduceTheMatrix) {
  const Eigen::Matrix3d essential = essential_of(sideways_motion(1.0));
  for (const Pose& motion : motions_from_essential(essential)) {
    EXPECT_LT(distance_between(essential_of(motion), essential), 1e-9);
    EXPECT_NEAR(motion.translation.norm(), 1.0, 1e-12);
    EXPECT_NEAR(motion.rotation.toRotationMatrix().determinant(), 1.0, 1e-9);
  }
}

}  // namespace
}  // namespace byre
