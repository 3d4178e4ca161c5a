#include "byre/optimise/bundle_adjustment.h"

#include "byre/geometry/geometry_matchers.h"
#include "byre/geometry/median.h"
#include "byre/optimise/bundle_scene.h"
#include "byre/optimise/robust_error.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace byre {
namespace {

using testing::Each;
using testing::Lt;

void expect_recovered(const BundleResult& result, const BundleProblem& truth, double tolerance) {
  ASSERT_TRUE(result.usable);
  for (std::size_t i = 0; i < truth.poses.size(); ++i) {
    EXPECT_THAT(result.camera_from_world[i], PoseNear(truth.poses[i].camera_from_world, tolerance, tolerance))
        << "pose " << i;
  }
  for (std::size_t i = 0; i < truth.points.size(); ++i) {
    EXPECT_THAT(result.points_in_world[i], PointNear(truth.points[i].position_in_world, tolerance)) << "point " << i;
  }
}

bool identical(const Pose& first, const Pose& second) {
  return first.rotation.coeffs() == second.rotation.coeffs() && first.translation == second.translation;
}

// Indices of one observation of every third point with at least five observations.
std::vector<int> one_observation_of_well_seen_points(const BundleProblem& problem) {
  std::vector<int> indices;
  for (int point = 0; point < static_cast<int>(problem.points.size()); point += 3) {
    const auto first = std::ranges::find(problem.observations, point, &BundleObservation::point);
    if (std::ranges::count(problem.observations, point, &BundleObservation::point) < 5) continue;
    indices.push_back(static_cast<int>(first - problem.observations.begin()));
  }
  return indices;
}

TEST(BundleAdjust, RecoversCleanStereoExactly) {
  const BundleScene scene = make_scene(1, {});
  const BundleResult result = bundle_adjust(scene.problem, patient());
  expect_recovered(result, scene.truth, 1e-6);
  EXPECT_THAT(result.squared_errors, Each(Lt(1e-6)));
}

TEST(BundleAdjust, RecoversCleanMonoBetweenTwoAnchors) {
  const BundleScene scene = make_scene(2, {.mono_fraction = 1.0, .start_position = 0.02, .start_rotation = 0.01});
  expect_recovered(bundle_adjust(scene.problem, patient()), scene.truth, 1e-5);
}

// Index of the camera that starts farthest from the first one, and its distance.
std::pair<int, double> farthest(const BundleProblem& problem) {
  std::pair<int, double> result{0, 0.0};
  for (int i = 0; i < static_cast<int>(problem.poses.size()); ++i) {
    const double distance =
        (problem.poses[0].camera_from_world * inverse(problem.poses[i].camera_from_world)).translation.norm();
    if (distance > result.second) result = {i, distance};
  }
  return result;
}

TEST(BundleAdjust, HoldsTheUnobservableScaleOfOneCamera) {
  BundleScene scene =
      make_scene(2, {.fixed_poses = 1, .mono_fraction = 1.0, .start_position = 0.01, .start_rotation = 0.005});
  const auto [held, distance] = farthest(scene.problem);
  BundleOptions options = patient();
  options.covariance_of_pose = 2;
  const BundleResult result = bundle_adjust(scene.problem, options);
  const auto from_first = [&](const std::vector<BundlePose>& poses, int i) -> Eigen::Vector3d {
    return inverse(poses[i].camera_from_world).translation - inverse(poses[0].camera_from_world).translation;
  };
  BundleProblem solved = scene.problem;
  for (std::size_t i = 0; i < solved.poses.size(); ++i) solved.poses[i].camera_from_world = result.camera_from_world[i];
  EXPECT_NEAR(from_first(solved.poses, held).norm(), distance, 1e-3 * distance);
  const double scale = from_first(solved.poses, held).norm() / from_first(scene.truth.poses, held).norm();
  for (int i = 1; i < static_cast<int>(solved.poses.size()); ++i) {
    EXPECT_THAT(from_first(solved.poses, i), PointNear(scale * from_first(scene.truth.poses, i), 1e-5)) << "pose " << i;
  }
  EXPECT_TRUE(result.pose_covariance);
}

TEST(BundleAdjust, RecoversMorePosesThanTheDenseSolverAccepts) {
  const BundleScene scene = make_scene(3, {.moving_poses = 70, .points = 400});
  expect_recovered(bundle_adjust(scene.problem, patient()), scene.truth, 1e-6);
}

TEST(BundleAdjust, RecoversPosesFromFixedPointsAlone) {
  const BundleScene scene = make_scene(4, {.fixed_poses = 0, .fixed_points = 80});
  expect_recovered(bundle_adjust(scene.problem, patient()), scene.truth, 1e-7);
}

TEST(BundleAdjust, RecoversPointsFromFixedPosesAlone) {
  const BundleScene scene = make_scene(5, {.fixed_poses = 4, .moving_poses = 0});
  expect_recovered(bundle_adjust(scene.problem, patient()), scene.truth, 1e-6);
}

TEST(BundleAdjust, HasSmallErrorsUnderNoise) {
  const BundleScene scene = make_scene(6, {.points = 300, .noise = 1.0});
  const BundleResult result = bundle_adjust(scene.problem, patient());
  ASSERT_TRUE(result.usable);
  for (std::size_t i = 0; i < scene.truth.poses.size(); ++i) {
    EXPECT_THAT(result.camera_from_world[i], PoseNear(scene.truth.poses[i].camera_from_world, 0.01, 0.004));
  }
  EXPECT_GT(median(result.squared_errors), 0.5);
  EXPECT_LT(median(result.squared_errors), 2.5);
}

TEST(BundleAdjust, IsRobustToOutliersAndReportsTheirErrors) {
  BundleScene scene = make_scene(7, {.points = 200, .noise = 1.0});
  const std::vector<int> outliers = one_observation_of_well_seen_points(scene.problem);
  ASSERT_GT(outliers.size(), 30u);
  for (const int i : outliers) scene.problem.observations[i].measured.head<2>() += Eigen::Vector2d(40.0, -30.0);
  const BundleResult result = bundle_adjust(scene.problem, patient());
  ASSERT_TRUE(result.usable);
  for (const int i : outliers) EXPECT_GT(result.squared_errors[i], 100.0) << "observation " << i;
  EXPECT_LT(median(result.squared_errors), 2.5);
  for (std::size_t i = 0; i < scene.truth.poses.size(); ++i) {
    EXPECT_THAT(result.camera_from_world[i], PoseNear(scene.truth.poses[i].camera_from_world, 0.02, 0.008));
  }
}

TEST(BundleAdjust, LeavesFixedElementsBitIdentical) {
  const BundleScene scene = make_scene(8, {.fixed_points = 40, .noise = 1.0});
  const BundleResult result = bundle_adjust(scene.problem, {});
  for (std::size_t i = 0; i < scene.problem.poses.size(); ++i) {
    const BundlePose& pose = scene.problem.poses[i];
    EXPECT_EQ(identical(result.camera_from_world[i], pose.camera_from_world), pose.fixed) << "pose " << i;
  }
  for (std::size_t i = 0; i < scene.problem.points.size(); ++i) {
    const BundlePoint& point = scene.problem.points[i];
    EXPECT_EQ(result.points_in_world[i] == point.position_in_world, point.fixed) << "point " << i;
  }
}

TEST(BundleAdjust, LeavesUnobservedElementsBitIdentical) {
  BundleScene scene = make_scene(9, {.noise = 1.0});
  scene.problem.poses.push_back({exp_pose(Vector6::Constant(0.3)), 0, false});
  scene.problem.points.push_back({Eigen::Vector3d(1.0, 2.0, 3.0), false});
  const BundleResult result = bundle_adjust(scene.problem, {});
  EXPECT_TRUE(identical(result.camera_from_world.back(), scene.problem.poses.back().camera_from_world));
  EXPECT_EQ(result.points_in_world.back(), scene.problem.points.back().position_in_world);
}

TEST(BundleAdjust, HoldsTheFirstObservedPoseIfNothingIsFixed) {
  BundleScene scene = make_scene(10, {.fixed_poses = 0, .noise = 1.0});
  std::erase_if(scene.problem.observations, [](const BundleObservation& observation) { return observation.pose == 0; });
  const BundleResult result = bundle_adjust(scene.problem, {});
  EXPECT_TRUE(identical(result.camera_from_world[1], scene.problem.poses[1].camera_from_world));
  EXPECT_FALSE(identical(result.camera_from_world[2], scene.problem.poses[2].camera_from_world));
}

TEST(BundleAdjust, IsDeterministic) {
  const BundleScene scene = make_scene(11, {.fixed_points = 20, .noise = 1.0});
  BundleOptions options;
  options.covariance_of_pose = 5;
  const BundleResult first = bundle_adjust(scene.problem, options);
  const BundleResult second = bundle_adjust(scene.problem, options);
  EXPECT_TRUE(std::ranges::equal(first.camera_from_world, second.camera_from_world, identical));
  EXPECT_EQ(first.points_in_world, second.points_in_world);
  EXPECT_EQ(first.squared_errors, second.squared_errors);
  ASSERT_TRUE(first.pose_covariance && second.pose_covariance);
  EXPECT_EQ(*first.pose_covariance, *second.pose_covariance);
}

double sum_of_huber(const std::vector<double>& squared_errors) {
  const double width = BundleOptions{}.huber_width;
  double sum = 0.0;
  for (const double error : squared_errors) sum += huber_cost(error, width);
  return sum;
}

// should_stop is called before the first and after each iteration.
BundleOptions stopping_after(int iterations) {
  BundleOptions options = patient();
  options.should_stop = [questions = 0, iterations]() mutable { return questions++ >= iterations; };
  return options;
}

TEST(BundleAdjust, ReturnsTheBestResultWhenStopped) {
  const BundleScene scene = make_scene(17, {.noise = 1.0});
  double previous = std::numeric_limits<double>::infinity();
  for (const int iterations : {0, 1, 2}) {
    const BundleResult stopped = bundle_adjust(scene.problem, stopping_after(iterations));
    EXPECT_TRUE(stopped.usable);
    EXPECT_EQ(stopped.iterations, iterations);
    EXPECT_LT(sum_of_huber(stopped.squared_errors), previous);
    previous = sum_of_huber(stopped.squared_errors);
  }
}

TEST(BundleAdjust, EqualsALimitOfIterationsWhenStopped) {
  const BundleScene scene = make_scene(18, {.noise = 1.0});
  BundleOptions two_iterations;
  two_iterations.max_iterations = 2;
  const BundleResult stopped = bundle_adjust(scene.problem, stopping_after(2));
  const BundleResult finished = bundle_adjust(scene.problem, two_iterations);
  EXPECT_TRUE(std::ranges::equal(stopped.camera_from_world, finished.camera_from_world, identical));
  EXPECT_EQ(stopped.points_in_world, finished.points_in_world);
}

TEST(BundleAdjust, IsUnaffectedByAStopFunction) {
  const BundleScene scene = make_scene(19, {.noise = 1.0});
  BundleOptions unstopped;
  unstopped.should_stop = [] { return false; };
  EXPECT_EQ(bundle_adjust(scene.problem, unstopped).points_in_world, bundle_adjust(scene.problem, {}).points_in_world);
}

TEST(BundleAdjust, IsIndependentOfTheOrderOfObservations) {
  const BundleScene scene = make_scene(20, {.moving_poses = 70, .points = 400, .noise = 1.0});
  BundleProblem reversed = scene.problem;
  std::ranges::reverse(reversed.observations);
  const BundleResult forward = bundle_adjust(scene.problem, patient());
  const BundleResult backward = bundle_adjust(reversed, patient());
  for (std::size_t i = 0; i < forward.camera_from_world.size(); ++i) {
    EXPECT_THAT(backward.camera_from_world[i], PoseNear(forward.camera_from_world[i], 1e-4, 1e-4)) << "pose " << i;
  }
}

TEST(BundleAdjust, AcceptsAnEmptyProblem) {
  const BundleResult result = bundle_adjust({}, {});
  EXPECT_TRUE(result.usable);
  EXPECT_TRUE(result.camera_from_world.empty());
  EXPECT_TRUE(result.squared_errors.empty());
}

TEST(BundleAdjust, OnlyEvaluatesAFixedProblem) {
  const BundleScene scene = make_scene(12, {.fixed_poses = 4, .moving_poses = 0, .points = 30, .fixed_points = 30});
  const BundleResult result = bundle_adjust(scene.problem, {});
  EXPECT_TRUE(result.usable);
  EXPECT_EQ(result.iterations, 0);
  EXPECT_EQ(result.squared_errors.size(), scene.problem.observations.size());
  EXPECT_THAT(result.squared_errors, Each(Lt(1e-12)));
}

TEST(BundleAdjust, IgnoresAPointBehindTheCameraWithInfiniteError) {
  BundleScene scene = make_scene(13, {});
  const int behind = static_cast<int>(scene.problem.points.size());
  const Pose world_from_camera = inverse(scene.truth.poses[3].camera_from_world);
  scene.problem.points.push_back({world_from_camera * Eigen::Vector3d(0.2, 0.1, -3.0), false});
  scene.problem.observations.push_back(
      {.pose = 3, .point = behind, .measured = {300.0, 200.0, 10.0}, .disparity_sigma = 0.4});
  const BundleResult result = bundle_adjust(scene.problem, patient());
  EXPECT_EQ(result.squared_errors.back(), std::numeric_limits<double>::infinity());
  EXPECT_EQ(result.points_in_world.back(), scene.problem.points.back().position_in_world);
  EXPECT_THAT(result.camera_from_world[3], PoseNear(scene.truth.poses[3].camera_from_world, 1e-6, 1e-6));
}

TEST(BundleAdjust, SurvivesPointsThatStartCloseToTheCamera) {
  BundleScene scene = make_scene(14, {});
  for (int i = 0; i < 10; ++i) {
    const Pose& camera_from_world = scene.problem.poses[i % 6].camera_from_world;
    scene.problem.points[i].position_in_world =
        inverse(camera_from_world) * Eigen::Vector3d(0.01, -0.02, 0.02 + 0.01 * i);
  }
  const BundleResult result = bundle_adjust(scene.problem, patient());
  ASSERT_TRUE(result.usable);
  EXPECT_TRUE(std::ranges::none_of(result.squared_errors, [](double error) { return std::isnan(error); }));
  EXPECT_LT(median(result.squared_errors), 1.0);
}

TEST(BundleAdjust, SurvivesPointsObservedOnceWithoutDisparity) {
  BundleScene scene = make_scene(15, {});
  const Eigen::Vector3d once_seen = inverse(scene.truth.poses[4].camera_from_world) * Eigen::Vector3d(0.1, 0.2, 2.0);
  scene.problem.points.push_back({once_seen, false});
  scene.problem.observations.push_back(
      {.pose = 4, .point = static_cast<int>(scene.problem.points.size()) - 1, .measured = {350.0, 300.0, 0.0}});
  const BundleResult result = bundle_adjust(scene.problem, patient());
  ASSERT_TRUE(result.usable);
  EXPECT_TRUE(result.points_in_world.back().allFinite());
  EXPECT_THAT(result.camera_from_world[4], PoseNear(scene.truth.poses[4].camera_from_world, 1e-5, 1e-5));
}

// Half of the observations of one pose come from a slightly displaced pose.
TEST(BundleAdjust, FollowsObservationsOfLargerWeight) {
  BundleSceneOptions options{.fixed_poses = 2, .moving_poses = 1, .points = 80, .fixed_points = 80};
  options.mono_fraction = 1.0;
  options.start_position = options.start_rotation = 0.0;
  const BundleScene scene = make_scene(17, options);
  const Pose aside = exp_pose((Vector6() << 0.002, 0.0, 0.0, 0.0, 0.0, 0.0).finished());
  const auto shift_towards_first_half = [&](double weight) {
    BundleProblem problem = scene.problem;
    for (BundleObservation& observation : problem.observations) {
      if (observation.point % 2 == 1 || observation.pose != 2) continue;
      const Pose moved = aside * problem.poses[2].camera_from_world;
      observation.measured = problem.rigs[0].project(moved * problem.points[observation.point].position_in_world);
      observation.weight = weight;
    }
    const BundleResult result = bundle_adjust(problem, patient());
    return (result.camera_from_world[2].translation - problem.poses[2].camera_from_world.translation).x() / 0.002;
  };
  EXPECT_NEAR(shift_towards_first_half(1.0), 0.5, 0.15);
  EXPECT_NEAR(shift_towards_first_half(9.0), 0.9, 0.05);
}

TEST(BundleAdjust, ReportsUnweightedErrorsAndCovariances) {
  const BundleScene scene = make_scene(18, {.noise = 1.0});
  BundleProblem weighted = scene.problem;
  for (BundleObservation& observation : weighted.observations) observation.weight = 4.0;
  BundleOptions options = patient();
  options.covariance_of_pose = 3;
  const BundleResult plain = bundle_adjust(scene.problem, options);
  const BundleResult result = bundle_adjust(weighted, options);
  ASSERT_TRUE(plain.pose_covariance && result.pose_covariance);
  EXPECT_NEAR(result.squared_errors.front(), plain.squared_errors.front(), 1e-3);
  EXPECT_LT((*result.pose_covariance - *plain.pose_covariance).norm(), 1e-3 * plain.pose_covariance->norm());
}

TEST(BundleAdjust, ReturnsTheInputWhenTheSolverFails) {
  BundleScene scene = make_scene(16, {});
  scene.problem.observations.front().measured.x() = std::numeric_limits<double>::quiet_NaN();
  const BundleResult result = bundle_adjust(scene.problem, {});
  EXPECT_FALSE(result.usable);
  EXPECT_TRUE(identical(result.camera_from_world[3], scene.problem.poses[3].camera_from_world));
  EXPECT_EQ(result.points_in_world[0], scene.problem.points[0].position_in_world);
}

}  // namespace
}  // namespace byre
