#include "byre/geometry/two_view.h"

#include "byre/geometry/degrees.h"
#include "byre/geometry/essential.h"
#include "byre/geometry/geometry_matchers.h"
#include "byre/geometry/two_view_scene.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

namespace byre {
namespace {

TwoViewFailure failure_of(const std::vector<TwoViewMatch>& matches) {
  return estimate_two_view_motion(matches).failure;
}

TEST(EstimateTwoViewMotion, IsExactOnCleanMatches) {
  const Pose truth = sideways_motion(0.4);
  const auto matches = matches_of(truth, room_depth, {});
  const auto found = estimate_two_view_motion(matches).motion;
  ASSERT_TRUE(found);
  EXPECT_LT(angle_between_translations(found->second_from_first, truth), 1e-6);
  EXPECT_LT(angle_between(found->second_from_first.rotation, truth.rotation), 1e-6);
  EXPECT_NEAR(found->second_from_first.translation.norm(), 1.0, 1e-12);
  EXPECT_EQ(found->point_count, 300);
  EXPECT_FALSE(found->is_planar);
}

TEST(EstimateTwoViewMotion, ReturnsDepthsInUnitsOfTheTranslation) {
  const auto constant = [](const Eigen::Vector3d&, double random) { return random < 0.5 ? 3.0 : 6.0; };
  const auto matches = matches_of(sideways_motion(0.4), constant, {});
  const auto found = estimate_two_view_motion(matches).motion;
  ASSERT_TRUE(found);
  for (const auto& point : found->points_in_first) {
    ASSERT_TRUE(point);
    const double depth = 0.4 * point->z();
    EXPECT_LT(std::min(std::abs(depth - 3.0), std::abs(depth - 6.0)), 1e-4);
  }
}

TEST(EstimateTwoViewMotion, IsRobustToNoiseAndOutliers) {
  for (std::uint32_t seed = 1; seed <= 20; ++seed) {
    const Pose truth = sideways_motion(0.5);
    const auto matches =
        matches_of(truth, room_depth, {.count = 300, .pixel_sigma = 0.5, .outlier_ratio = 0.3, .seed = seed});
    const auto found = estimate_two_view_motion(matches).motion;
    ASSERT_TRUE(found) << "seed " << seed;
    EXPECT_LT(angle_between_translations(found->second_from_first, truth), 1.5 * kDegree) << "seed " << seed;
    EXPECT_LT(angle_between(found->second_from_first.rotation, truth.rotation), 0.2 * kDegree) << "seed " << seed;
  }
}

TEST(EstimateTwoViewMotion, EstimatesAForwardMotion) {
  const Pose truth{rotation_exp({0.01, 0.02, 0.0}), {0.05, 0.0, -1.0}};
  const auto matches = matches_of(truth, room_depth, {.count = 400, .pixel_sigma = 0.5, .outlier_ratio = 0.2});
  const auto found = estimate_two_view_motion(matches).motion;
  ASSERT_TRUE(found);
  EXPECT_LT(angle_between_translations(found->second_from_first, truth), 1.0 * kDegree);
}

// One point in four is near. The others stay in view and have no parallax.
double street_depth(const Eigen::Vector3d&, double random) {
  return random < 0.25 ? 4.0 + 8.0 * random : 80.0;
}

TEST(EstimateTwoViewMotion, EstimatesAForwardMotionByTheNearestPoints) {
  const Pose truth{rotation_exp({0.01, 0.01, 0.0}), {0.05, 0.0, -1.0}};
  int found_count = 0;
  for (std::uint32_t seed = 1; seed <= 20; ++seed) {
    const auto matches = matches_of(truth, street_depth, {.count = 400, .pixel_sigma = 0.3, .seed = seed});
    EXPECT_EQ(estimate_two_view_motion(matches, StartParallax::of_median).failure, TwoViewFailure::small_parallax);
    const auto found = estimate_two_view_motion(matches).motion;
    if (!found) continue;
    ++found_count;
    EXPECT_LT(angle_between_translations(found->second_from_first, truth), 2.0 * kDegree) << "seed " << seed;
  }
  EXPECT_GE(found_count, 15);
}

// Errors of a rotation by calibration and rolling shutter resemble parallax.
TEST(EstimateTwoViewMotion, RejectsTheNearestPointsIfTheTurnExceedsTheirParallax) {
  const Pose truth{rotation_exp({0.01, 0.15, 0.0}), {0.05, 0.0, -1.0}};
  int small_count = 0;
  for (std::uint32_t seed = 1; seed <= 20; ++seed) {
    const auto matches = matches_of(truth, street_depth, {.count = 400, .pixel_sigma = 0.3, .seed = seed});
    const TwoViewEstimate estimate = estimate_two_view_motion(matches);
    EXPECT_FALSE(estimate.motion) << "seed " << seed;
    small_count += estimate.failure == TwoViewFailure::small_parallax;
  }
  EXPECT_GE(small_count, 15);
}

TEST(EstimateTwoViewMotion, RejectsATurnOnTheSpotAsRotation) {
  for (std::uint32_t seed = 1; seed <= 20; ++seed) {
    const Pose turn{rotation_exp({0.02, 0.2, -0.05}), Eigen::Vector3d::Zero()};
    const TwoViewSceneOptions scene{.count = 300, .pixel_sigma = 0.7, .outlier_ratio = 0.3, .seed = seed};
    EXPECT_EQ(failure_of(matches_of(turn, room_depth, scene)), TwoViewFailure::rotation_only) << "seed " << seed;
  }
}

TEST(EstimateTwoViewMotion, RejectsAStandingCameraAsRotation) {
  EXPECT_EQ(failure_of(matches_of({}, room_depth, {.pixel_sigma = 0.5})), TwoViewFailure::rotation_only);
}

TEST(EstimateTwoViewMotion, RejectsAMotionTooSmallForDepths) {
  for (const double metres : {0.01, 0.03, 0.05}) {
    const auto failure = failure_of(matches_of(sideways_motion(metres), room_depth, {.pixel_sigma = 0.3}));
    EXPECT_THAT(failure, testing::AnyOf(TwoViewFailure::rotation_only, TwoViewFailure::small_parallax)) << metres;
  }
}

TEST(EstimateTwoViewMotion, ReportsSmallParallax) {
  EXPECT_EQ(failure_of(matches_of(sideways_motion(0.05), room_depth, {})), TwoViewFailure::small_parallax);
}

// The other motion with the same homography has half of the wall behind the cameras.
TEST(EstimateTwoViewMotion, EstimatesAMotionAlongAWall) {
  const auto wall_in_front = [](const Eigen::Vector3d&, double) { return 4.0; };
  for (std::uint32_t seed = 1; seed <= 20; ++seed) {
    const Pose truth{rotation_exp({0.02, -0.05, 0.03}), {0.6, 0.0, 0.0}};
    const auto matches = matches_of(truth, wall_in_front, {.count = 300, .pixel_sigma = 0.5, .seed = seed});
    const auto found = estimate_two_view_motion(matches).motion;
    ASSERT_TRUE(found) << "seed " << seed;
    EXPECT_TRUE(found->is_planar);
    EXPECT_LT(angle_between_translations(found->second_from_first, truth), 2.0 * kDegree) << "seed " << seed;
  }
}

TEST(EstimateTwoViewMotion, ReportsPlanarAmbiguity) {
  for (std::uint32_t seed = 1; seed <= 20; ++seed) {
    const Pose truth{rotation_exp({0.02, -0.05, 0.03}), {-0.4, 0.0, -0.4}};
    const TwoViewSceneOptions scene{.count = 300, .pixel_sigma = 0.5, .seed = seed};
    EXPECT_EQ(failure_of(matches_of(truth, wall_depth, scene)), TwoViewFailure::planar_ambiguity) << "seed " << seed;
  }
}

// The measured motion errs by 2 degrees in its rotation and 6 degrees in its direction.
TEST(EstimateTwoViewMotion, ResolvesAPlaneByAMeasuredMotion) {
  const Pose truth{rotation_exp({0.02, -0.05, 0.03}), {-0.4, 0.0, -0.4}};
  const Pose measured{rotation_exp({0.0, 2.0 * kDegree, 0.0}) * truth.rotation, {-0.44, 0.0, -0.36}};
  for (std::uint32_t seed = 1; seed <= 20; ++seed) {
    const auto matches = matches_of(truth, wall_depth, {.count = 300, .pixel_sigma = 0.5, .seed = seed});
    const auto found = estimate_two_view_motion(matches, StartParallax::of_median, measured).motion;
    ASSERT_TRUE(found) << "seed " << seed;
    EXPECT_LT(angle_between_translations(found->second_from_first, truth), 3.0 * kDegree) << "seed " << seed;
  }
}

TEST(EstimateTwoViewMotion, FollowsTheImagesIfTheMeasuredMotionIsWrong) {
  const Pose truth = sideways_motion(0.5);
  Pose wrong = truth;
  wrong.translation *= -1.0;
  for (std::uint32_t seed = 1; seed <= 20; ++seed) {
    const auto matches = matches_of(truth, room_depth, {.count = 300, .pixel_sigma = 0.5, .seed = seed});
    const auto found = estimate_two_view_motion(matches, StartParallax::of_median, wrong).motion;
    ASSERT_TRUE(found) << "seed " << seed;
    EXPECT_LT(angle_between_translations(found->second_from_first, truth), 1.5 * kDegree) << "seed " << seed;
  }
}

TEST(EstimateTwoViewMotion, AcceptsTheLeastParallaxIfRequested) {
  const Pose truth{Eigen::Quaterniond::Identity(), {0.02, 0.0, -0.3}};
  int found_count = 0;
  for (std::uint32_t seed = 1; seed <= 20; ++seed) {
    const auto matches = matches_of(truth, street_depth, {.count = 400, .pixel_sigma = 0.3, .seed = seed});
    EXPECT_FALSE(estimate_two_view_motion(matches).motion) << "seed " << seed;
    const auto found = estimate_two_view_motion(matches, StartParallax::least, truth).motion;
    if (!found) continue;
    ++found_count;
    EXPECT_LT(angle_between_translations(found->second_from_first, truth), 3.0 * kDegree) << "seed " << seed;
  }
  EXPECT_GE(found_count, 15);
}

TEST(EstimateTwoViewMotion, ResolvesAPlaneByPointsInFrontOfIt) {
  const auto furnished = [](const Eigen::Vector3d& ray, double random) {
    return wall_depth(ray, random) * (random < 0.25 ? 0.5 + random : 1.0);
  };
  for (std::uint32_t seed = 1; seed <= 20; ++seed) {
    const Pose truth{rotation_exp({0.02, -0.05, 0.03}), {-0.4, 0.0, -0.4}};
    const auto matches = matches_of(truth, furnished, {.count = 300, .pixel_sigma = 0.5, .seed = seed});
    const auto found = estimate_two_view_motion(matches).motion;
    ASSERT_TRUE(found) << "seed " << seed;
    EXPECT_LT(angle_between_translations(found->second_from_first, truth), 2.0 * kDegree) << "seed " << seed;
  }
}

TEST(EstimateTwoViewMotion, RejectsTooFewMatches) {
  const auto matches = matches_of(sideways_motion(0.4), room_depth, {.count = 99});
  EXPECT_EQ(failure_of(matches), TwoViewFailure::too_few_matches);
  EXPECT_EQ(failure_of({}), TwoViewFailure::too_few_matches);
}

TEST(EstimateTwoViewMotion, RejectsInconsistentMatches) {
  const auto matches = matches_of(sideways_motion(0.4), room_depth, {.count = 150, .outlier_ratio = 1.0});
  EXPECT_EQ(failure_of(matches), TwoViewFailure::no_common_motion);
}

TEST(EstimateTwoViewMotion, IsDeterministicForASeed) {
  const auto matches = matches_of(sideways_motion(0.4), room_depth, {.pixel_sigma = 0.5, .outlier_ratio = 0.3});
  const auto first = estimate_two_view_motion(matches).motion;
  const auto second = estimate_two_view_motion(matches).motion;
  ASSERT_TRUE(first && second);
  EXPECT_EQ(first->second_from_first.rotation.coeffs(), second->second_from_first.rotation.coeffs());
  EXPECT_EQ(first->second_from_first.translation, second->second_from_first.translation);
  EXPECT_EQ(first->points_in_first, second->points_in_first);
}

TEST(RefineMotion, MinimisesTheErrors) {
  const auto matches = matches_of(sideways_motion(0.4), room_depth, {.pixel_sigma = 0.5});
  const auto cost_of = [&](const Pose& motion) {
    double cost = 0.0;
    for (const TwoViewMatch& match : matches) {
      cost += std::min(epipolar_error(essential_of(motion), match), kMaxEpipolarError);
    }
    return cost;
  };
  Pose start = sideways_motion(1.0);
  start.rotation = rotation_exp({0.001, -0.001, 0.001}) * start.rotation;
  const Pose refined = refine_motion(start, matches);
  EXPECT_LT(cost_of(refined), cost_of(start));
  EXPECT_LT(angle_between_translations(refined, sideways_motion(1.0)), 1.0 * kDegree);
  for (int axis = 0; axis < 3; ++axis) {
    for (const double step : {-2e-3, 2e-3}) {
      Pose turned = refined;
      turned.rotation = rotation_exp(step * Eigen::Vector3d::Unit(axis)) * turned.rotation;
      EXPECT_GT(cost_of(turned), cost_of(refined));
    }
  }
}

TEST(DirectionSigma, EstimatesTheErrorOfTheDirection) {
  double squared_sum = 0.0;
  constexpr int kTrials = 30;
  for (std::uint32_t seed = 1; seed <= kTrials; ++seed) {
    const Pose truth = sideways_motion(0.4);
    const auto matches = matches_of(truth, room_depth, {.pixel_sigma = 0.5, .seed = seed});
    const Pose refined = refine_motion(truth, matches);
    squared_sum += std::pow(angle_between_translations(refined, truth) / direction_sigma(refined, matches), 2);
  }
  EXPECT_GT(squared_sum / kTrials, 0.5);  // expected: 1, from the least determined direction
  EXPECT_LT(squared_sum / kTrials, 2.0);
}

TEST(DirectionSigma, IsLargerForASmallerMotion) {
  const auto sigma_after = [](double metres) {
    const Pose motion = sideways_motion(metres);
    return direction_sigma(motion, matches_of(motion, room_depth, {.pixel_sigma = 0.5}));
  };
  EXPECT_GT(sigma_after(0.1), 2.0 * sigma_after(0.4));
}

TEST(DirectionSigma, IsInfiniteForAnUnconstrainedDirection) {
  const Pose motion = sideways_motion(0.4);
  EXPECT_FALSE(std::isfinite(direction_sigma(motion, {})));
  EXPECT_FALSE(std::isfinite(direction_sigma(motion, matches_of(motion, room_depth, {.count = 4}))));
}

}  // namespace
}  // namespace byre
