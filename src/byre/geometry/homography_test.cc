#include "byre/geometry/homography.h"

#include "byre/geometry/geometry_matchers.h"
#include "byre/geometry/two_view_scene.h"

#include <algorithm>

#include <gtest/gtest.h>

namespace byre {
namespace {

using ::testing::Contains;
using ::testing::IsEmpty;
using ::testing::SizeIs;

Pose with_unit_translation(Pose motion) {
  motion.translation.normalize();
  return motion;
}

double largest_transfer_error(const Eigen::Matrix3d& homography, const std::vector<TwoViewMatch>& matches) {
  double largest = 0.0;
  for (const TwoViewMatch& match : matches) {
    const Eigen::Vector3d transferred = homography * match.ray_in_first;
    largest = std::max(largest, (transferred / transferred.z() - match.ray_in_second).norm());
  }
  return largest;
}

TEST(FitHomography, IsExactForAPlane) {
  const auto matches = matches_of(sideways_motion(0.5), wall_depth, {.count = 20});
  const auto homography = fit_homography(matches);
  ASSERT_TRUE(homography);
  EXPECT_LT(largest_transfer_error(*homography, matches), 1e-9);
}

TEST(FitHomography, NeedsOnlyFourMatches) {
  const auto matches = matches_of(sideways_motion(0.5), wall_depth, {.count = 40});
  const auto homography = fit_homography(std::span(matches).first(4));
  ASSERT_TRUE(homography);
  EXPECT_LT(largest_transfer_error(*homography, matches), 1e-7);
}

TEST(FitHomography, IsTheRotationOfATurnOnTheSpot) {
  const Pose turn{rotation_exp({0.05, -0.1, 0.2}), Eigen::Vector3d::Zero()};
  const auto homography = fit_homography(matches_of(turn, room_depth, {.count = 20}));
  ASSERT_TRUE(homography);
  EXPECT_LT((*homography - turn.rotation.toRotationMatrix()).norm(), 1e-9);
}

TEST(FitHomography, AveragesNoise) {
  const auto noisy = matches_of(sideways_motion(0.5), wall_depth, {.count = 300, .pixel_sigma = 0.5});
  const auto exact = matches_of(sideways_motion(0.5), wall_depth, {.count = 300, .seed = 2});
  const auto homography = fit_homography(noisy);
  ASSERT_TRUE(homography);
  EXPECT_LT(largest_transfer_error(*homography, exact), 0.5 / one_camera().focal);
}

TEST(FitHomography, IsEmptyWithFewerThanFourMatches) {
  const auto matches = matches_of(sideways_motion(0.5), wall_depth, {.count = 3});
  EXPECT_FALSE(fit_homography(matches));
  EXPECT_FALSE(fit_homography({}));
}

TEST(FitHomography, IsEmptyForCollinearPoints) {
  const auto on_a_line = [](double at) {
    return TwoViewMatch{{at, 0.5 * at, 1.0}, {0.9 * at + 0.1, 0.45 * at, 1.0}, 1e-3};
  };
  const std::vector<TwoViewMatch> line = {on_a_line(-0.4), on_a_line(-0.1), on_a_line(0.2), on_a_line(0.5)};
  EXPECT_FALSE(fit_homography(line));
  EXPECT_FALSE(fit_homography(std::vector<TwoViewMatch>(6, line.front())));
}

TEST(MotionsFromHomography, IncludeTheTrueMotion) {
  for (const double metres : {0.1, 0.5, 1.0}) {
    const Pose motion = sideways_motion(metres);
    const auto homography = fit_homography(matches_of(motion, wall_depth, {.count = 50}));
    ASSERT_TRUE(homography);
    const auto motions = motions_from_homography(*homography);
    EXPECT_THAT(motions, SizeIs(4));
    EXPECT_THAT(motions, Contains(PoseNear(with_unit_translation(motion), 1e-6, 1e-6)));
  }
}

TEST(MotionsFromHomography, IncludeTheTrueMotionTowardsAWall) {
  const Pose motion{Eigen::Quaterniond::Identity(), {0.0, 0.0, -1.0}};
  const auto frontal = [](const Eigen::Vector3d&, double) { return 4.0; };
  const auto homography = fit_homography(matches_of(motion, frontal, {.count = 50}));
  ASSERT_TRUE(homography);
  EXPECT_THAT(motions_from_homography(*homography), Contains(PoseNear(motion, 1e-6, 1e-6)));
}

TEST(MotionsFromHomography, AreEmptyForARotation) {
  EXPECT_THAT(motions_from_homography(rotation_exp({0.1, 0.2, -0.1}).toRotationMatrix()), IsEmpty());
}

}  // namespace
}  // namespace byre
