#include "byre/optimise/bundle_covariance.h"

#include "byre/optimise/bundle_scene.h"
#include "byre/optimise/reprojection.h"

#include <cmath>

#include <Eigen/LU>
#include <gtest/gtest.h>

namespace byre {
namespace {

constexpr double kHuberWidth = 2.0;  // sigmas

Eigen::VectorXd residuals(const BundleProblem& problem) {
  Eigen::VectorXd result(3 * problem.observations.size());
  for (std::size_t i = 0; i < problem.observations.size(); ++i) {
    const BundleObservation& observation = problem.observations[i];
    const Reprojection reprojection(problem.rigs[0], observation.measured, observation.pixel_sigma,
                                    observation.disparity_sigma);
    result.segment<3>(3 * i) = reprojection.residual(problem.poses[observation.pose].camera_from_world *
                                                     problem.points[observation.point].position_in_world);
  }
  return result;
}

// The problem with its moving poses, then its moving points, displaced.
BundleProblem displaced(BundleProblem problem, const Eigen::VectorXd& delta) {
  Eigen::Index next = 0;
  for (BundlePose& pose : problem.poses) {
    if (pose.fixed) continue;
    pose.camera_from_world = exp_pose(delta.segment<6>(next)) * pose.camera_from_world;
    next += 6;
  }
  for (BundlePoint& point : problem.points) {
    if (point.fixed) continue;
    point.position_in_world += delta.segment<3>(next);
    next += 3;
  }
  return problem;
}

// Inverse of the full normal matrix, from central differences.
Eigen::MatrixXd full_covariance(const BundleProblem& problem) {
  constexpr double kStep = 1e-6;
  const auto poses = std::ranges::count(problem.poses, false, &BundlePose::fixed);
  const auto points = std::ranges::count(problem.points, false, &BundlePoint::fixed);
  const Eigen::Index size = 6 * poses + 3 * points;
  Eigen::MatrixXd jacobian(3 * problem.observations.size(), size);
  for (Eigen::Index i = 0; i < size; ++i) {
    const Eigen::VectorXd step = kStep * Eigen::VectorXd::Unit(size, i);
    jacobian.col(i) = (residuals(displaced(problem, step)) - residuals(displaced(problem, -step))) / (2.0 * kStep);
  }
  return (jacobian.transpose() * jacobian).inverse();
}

TEST(MarginalCovariance, IsTheBlockOfTheFullInverse) {
  const BundleProblem problem =
      make_scene(1, {.fixed_poses = 1, .moving_poses = 3, .points = 30, .fixed_points = 5}).truth;
  const Eigen::MatrixXd full = full_covariance(problem);
  for (int i = 0; i < 3; ++i) {
    const auto marginal = marginal_covariance(problem, {}, i + 1, kHuberWidth);
    ASSERT_TRUE(marginal);
    const Matrix6 expected = full.block<6, 6>(6 * i, 6 * i);
    EXPECT_LT((*marginal - expected).norm(), 1e-5 * expected.norm()) << "pose " << i + 1;
  }
}

TEST(MarginalCovariance, IsSymmetricAndPositiveDefinite) {
  const auto covariance = marginal_covariance(make_scene(2, {.noise = 1.0}).truth, {}, 4, kHuberWidth);
  ASSERT_TRUE(covariance);
  EXPECT_LT((*covariance - covariance->transpose()).norm(), 1e-12 * covariance->norm());
  EXPECT_GT(covariance->determinant(), 0.0);
}

TEST(MarginalCovariance, GrowsWithTheWeightLossOfOutliers) {
  BundleProblem problem = make_scene(3, {}).truth;
  const auto clean = marginal_covariance(problem, {}, 4, kHuberWidth);
  for (std::size_t i = 0; i < problem.observations.size(); i += 4) problem.observations[i].measured.x() += 50.0;
  const auto with_outliers = marginal_covariance(problem, {}, 4, kHuberWidth);
  ASSERT_TRUE(clean && with_outliers);
  EXPECT_GT(with_outliers->trace(), 1.1 * clean->trace());
}

TEST(MarginalCovariance, IgnoresAPointObservedOnceWithoutDisparity) {
  BundleProblem problem = make_scene(4, {}).truth;
  const auto before = marginal_covariance(problem, {}, 4, kHuberWidth);
  const Eigen::Vector3d point_in_camera(0.1, 0.2, 2.0);
  problem.points.push_back({inverse(problem.poses[4].camera_from_world) * point_in_camera, false});
  problem.observations.push_back({.pose = 4,
                                  .point = static_cast<int>(problem.points.size()) - 1,
                                  .measured = problem.rigs[0].project(point_in_camera)});
  const auto after = marginal_covariance(problem, {}, 4, kHuberWidth);
  ASSERT_TRUE(before && after);
  EXPECT_LT((*after - *before).norm(), 1e-6 * before->norm());
}

// Four times as many observations halve the error by noise, not the error that neighbours share.
TEST(MarginalCovariance, DoesNotAverageOutErrorsThatNeighboursShare) {
  const BundleProblem few = make_scene(8, {.points = 40, .fixed_points = 40}).truth;
  BundleProblem many = few;
  for (int i = 0; i < 3; ++i) {
    many.observations.insert(many.observations.end(), few.observations.begin(), few.observations.end());
  }
  const auto variance_of = [](const BundleProblem& problem, double systematic_sigma) {
    return marginal_covariance(with_shared_errors(problem, systematic_sigma), {}, 4, kHuberWidth).value().trace();
  };
  EXPECT_NEAR(variance_of(many, 0.0), 0.25 * variance_of(few, 0.0), 1e-3 * variance_of(few, 0.0));
  EXPECT_GT(variance_of(many, 10.0), 0.95 * variance_of(few, 10.0));
}

TEST(MarginalCovariance, IsEmptyForAFixedOrUnobservedPose) {
  BundleProblem problem = make_scene(5, {}).truth;
  problem.poses.push_back({Pose{}, 0, false});
  EXPECT_FALSE(marginal_covariance(problem, {}, 0, kHuberWidth));
  EXPECT_FALSE(marginal_covariance(problem, {}, static_cast<int>(problem.poses.size()) - 1, kHuberWidth));
}

TEST(MarginalCovariance, IsEmptyIfTheScaleIsFree) {
  const BundleProblem problem = make_scene(6, {.fixed_poses = 1, .mono_fraction = 1.0}).truth;
  EXPECT_FALSE(marginal_covariance(problem, {}, 2, kHuberWidth));
}

TEST(MarginalCovariance, IsEmptyForTooFewObservations) {
  BundleProblem problem = make_scene(7, {}).truth;
  std::erase_if(problem.observations, [](const BundleObservation& observation) { return observation.pose == 5; });
  problem.observations.push_back({.pose = 5, .point = 0, .measured = {300.0, 200.0, 0.0}});
  problem.points[0].position_in_world = inverse(problem.poses[5].camera_from_world) * Eigen::Vector3d(0.0, 0.0, 3.0);
  EXPECT_FALSE(marginal_covariance(problem, {}, 5, kHuberWidth));
}

TEST(BundleAdjust, ReturnsACovarianceOnRequestOnly) {
  EXPECT_FALSE(bundle_adjust(make_scene(8, {}).problem, {}).pose_covariance);
}

// The covariances equal those of separate calls, in a large problem too.
TEST(BundleAdjust, ReturnsCovariancesOfSeveralPoses) {
  const BundleScene scene =
      make_scene(2, {.moving_poses = 5, .points = 60, .fixed_points = 10, .noise = 1.0, .start_position = 0.02});
  BundleOptions options;
  options.max_iterations = 30;
  options.covariances_of_poses = {5, 3};
  const BundleResult several = bundle_adjust(scene.problem, options);
  ASSERT_EQ(several.pose_covariances.size(), 2u);
  for (std::size_t i = 0; i < 2; ++i) {
    options.covariance_of_pose = options.covariances_of_poses[i];
    const BundleResult one = bundle_adjust(scene.problem, options);
    ASSERT_TRUE(one.pose_covariance);
    EXPECT_TRUE(several.pose_covariances[i].isApprox(*one.pose_covariance, 1e-4));
  }
}

// Squared normalised errors of repeated trials follow chi-square; the bounds hold with 99.9 %.
TEST(BundleAdjust, ReturnsACovarianceThatMatchesItsErrors) {
  constexpr int kTrials = 200;
  constexpr double kDegrees = 6.0 * kTrials;
  BundleOptions options;
  options.max_iterations = 30;
  options.covariance_of_pose = 3;
  double sum = 0.0;
  for (unsigned seed = 0; seed < kTrials; ++seed) {
    const BundleScene scene =
        make_scene(seed, {.moving_poses = 3, .points = 60, .fixed_points = 10, .noise = 1.0, .start_position = 0.02});
    const BundleResult result = bundle_adjust(scene.problem, options);
    ASSERT_TRUE(result.pose_covariance);
    const Vector6 error = log_pose(scene.truth.poses[3].camera_from_world * inverse(result.camera_from_world[3]));
    sum += error.dot(result.pose_covariance->inverse() * error);
  }
  EXPECT_GT(sum, kDegrees - 3.3 * std::sqrt(2.0 * kDegrees));
  EXPECT_LT(sum, kDegrees + 3.3 * std::sqrt(2.0 * kDegrees));
}

}  // namespace
}  // namespace byre
