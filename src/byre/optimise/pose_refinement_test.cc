#include "byre/optimise/pose_refinement.h"

#include "byre/geometry/geometry_matchers.h"
#include "byre/optimise/optimise_scene.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include <Eigen/LU>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace byre {
namespace {

using testing::Each;

constexpr double kPixelSigma = 0.8;
constexpr double kDisparitySigma = 0.4;

struct SceneOptions {
  int points = 100;
  double mono_fraction = 0.0;
  double noise = 0.0;               // sigmas
  double point_sigma = 0.0;         // metres, of the map points
  double prediction_metres = 0.05;  // error of the prediction
  double prediction_radians = 0.03;
};

struct Scene {
  Rig rig = stereo_rig();
  Pose true_camera_from_world;
  Pose predicted_camera_from_world;
  std::vector<PoseObservation> observations;

  std::optional<PoseRefinement> refine(const PoseRefinementOptions& options = {}) const {
    return refine_pose(predicted_camera_from_world, rig, observations, options);
  }
  std::optional<PoseRefinement> refine_with(const PosePrior& prior, const PoseRefinementOptions& options = {}) const {
    return refine_pose(predicted_camera_from_world, rig, observations, options, prior);
  }
};

PoseObservation observe(const Scene& scene, const SceneOptions& options, Draw& draw) {
  const Eigen::Vector3d point_in_camera = draw.point_in_view(scene.rig);
  PoseObservation observation;
  observation.point_in_world = inverse(scene.true_camera_from_world) * point_in_camera;
  observation.point_in_world += draw.normal3(options.point_sigma);
  observation.point_covariance = options.point_sigma * options.point_sigma * Eigen::Matrix3d::Identity();
  observation.measured = scene.rig.project(point_in_camera);
  observation.measured +=
      options.noise * Eigen::Vector3d{draw.normal(kPixelSigma), draw.normal(kPixelSigma), draw.normal(kDisparitySigma)};
  observation.pixel_sigma = kPixelSigma;
  if (draw.uniform(0.0, 1.0) >= options.mono_fraction) observation.disparity_sigma = kDisparitySigma;
  return observation;
}

Scene make_scene(unsigned seed, const SceneOptions& options) {
  Draw draw(seed);
  Scene scene;
  scene.true_camera_from_world = exp_pose(draw.motion(2.0, 1.0));
  const Vector6 delta = draw.motion(options.prediction_metres, options.prediction_radians);
  scene.predicted_camera_from_world = exp_pose(delta) * scene.true_camera_from_world;
  for (int i = 0; i < options.points; ++i) scene.observations.push_back(observe(scene, options, draw));
  return scene;
}

// Without systematic errors.
constexpr PoseRefinementOptions kNoiseAlone{.systematic_sigma = 0.0};

// Sum of squared normalised errors over trials.
double normalised_errors(int trials, const SceneOptions& options, double first_weight) {
  double sum = 0.0;
  for (int trial = 0; trial < trials; ++trial) {
    Scene scene = make_scene(static_cast<unsigned>(trial), options);
    for (int i = 0; i < options.points / 2; ++i) scene.observations[i].weight = first_weight;
    const auto refined = scene.refine(kNoiseAlone);
    if (!refined) return std::numeric_limits<double>::infinity();
    const Vector6 error = log_pose(scene.true_camera_from_world * inverse(refined->camera_from_world));
    sum += error.dot(refined->covariance.inverse() * error);
  }
  return sum;
}

TEST(RefinePose, RecoversCleanStereoExactly) {
  const Scene scene = make_scene(1, {});
  const auto refined = scene.refine();
  ASSERT_TRUE(refined);
  EXPECT_THAT(refined->camera_from_world, PoseNear(scene.true_camera_from_world, 1e-9, 1e-9));
  EXPECT_EQ(refined->inlier_count, 100);
  EXPECT_THAT(refined->inliers, Each(true));
}

TEST(RefinePose, RecoversCleanMonoExactly) {
  const Scene scene = make_scene(2, {.mono_fraction = 1.0});
  const auto refined = scene.refine();
  ASSERT_TRUE(refined);
  EXPECT_THAT(refined->camera_from_world, PoseNear(scene.true_camera_from_world, 1e-8, 1e-8));
}

TEST(RefinePose, RecoversFromAPoorPrediction) {
  const Scene scene = make_scene(3, {.prediction_metres = 0.3, .prediction_radians = 0.15});
  const auto refined = scene.refine({.rounds = 4, .iterations_per_round = 10});
  ASSERT_TRUE(refined);
  EXPECT_THAT(refined->camera_from_world, PoseNear(scene.true_camera_from_world, 1e-8, 1e-8));
}

TEST(RefinePose, HasSmallErrorsUnderNoise) {
  const Scene scene = make_scene(4, {.points = 300, .mono_fraction = 0.3, .noise = 1.0});
  const auto refined = scene.refine();
  ASSERT_TRUE(refined);
  EXPECT_THAT(refined->camera_from_world, PoseNear(scene.true_camera_from_world, 0.01, 0.003));
  EXPECT_GT(refined->inlier_count, 265);  // 95 % pass the gates
}

TEST(RefinePose, RejectsOutliers) {
  Scene scene = make_scene(5, {.points = 200, .noise = 1.0});
  for (std::size_t i = 0; i < scene.observations.size(); i += 4) {
    scene.observations[i].measured.head<2>() += Eigen::Vector2d(25.0, -40.0);
  }
  const auto refined = scene.refine();
  ASSERT_TRUE(refined);
  EXPECT_THAT(refined->camera_from_world, PoseNear(scene.true_camera_from_world, 0.01, 0.003));
  for (std::size_t i = 0; i < scene.observations.size(); i += 4) EXPECT_FALSE(refined->inliers[i]) << i;
  EXPECT_GT(refined->inlier_count, 130);
}

TEST(RefinePose, CountsPointsAtOrBehindTheCameraAsOutliers) {
  Scene scene = make_scene(6, {});
  const Pose world_from_camera = inverse(scene.true_camera_from_world);
  scene.observations[0].point_in_world = world_from_camera * Eigen::Vector3d(0.1, 0.1, -2.0);
  scene.observations[1].point_in_world = world_from_camera.translation;
  const auto refined = scene.refine();
  ASSERT_TRUE(refined);
  EXPECT_FALSE(refined->inliers[0]);
  EXPECT_FALSE(refined->inliers[1]);
  EXPECT_EQ(refined->inlier_count, 98);
  EXPECT_THAT(refined->camera_from_world, PoseNear(scene.true_camera_from_world, 1e-9, 1e-9));
}

TEST(RefinePose, RecoversWithMostPointsBehindTheCamera) {
  Scene scene = make_scene(19, {});
  for (int i = 0; i < 70; ++i) {
    scene.observations[i].point_in_world =
        inverse(scene.true_camera_from_world) * Eigen::Vector3d(0.1, 0.1, -1.0 - 0.05 * i);
  }
  const auto refined = scene.refine();
  ASSERT_TRUE(refined);
  EXPECT_EQ(refined->inlier_count, 30);
  EXPECT_THAT(refined->camera_from_world, PoseNear(scene.true_camera_from_world, 1e-9, 1e-9));
}

TEST(RefinePose, CountsNonFiniteObservationsAsOutliers) {
  Scene scene = make_scene(16, {});
  scene.observations[0].measured.x() = std::numeric_limits<double>::quiet_NaN();
  scene.observations[1].point_in_world.setConstant(std::numeric_limits<double>::quiet_NaN());
  const auto refined = scene.refine();
  ASSERT_TRUE(refined);
  EXPECT_EQ(refined->inlier_count, 98);
  EXPECT_THAT(refined->camera_from_world, PoseNear(scene.true_camera_from_world, 1e-9, 1e-9));
}

TEST(RefinePose, EstimatesTheVarianceFactor) {
  const auto as_stated = make_scene(17, {.points = 400, .noise = 1.0}).refine();
  const auto larger = make_scene(17, {.points = 400, .noise = 2.0}).refine();
  ASSERT_TRUE(as_stated && larger);
  EXPECT_NEAR(as_stated->variance_factor, 1.0, 0.2);
  EXPECT_NEAR(larger->variance_factor, 4.0, 0.8);
  EXPECT_GT(larger->inlier_count, 350);
  EXPECT_GT(larger->covariance.trace(), 3.0 * as_stated->covariance.trace());
}

TEST(RefinePose, BoundsTheVarianceFactor) {
  const auto clean = make_scene(18, {}).refine();
  const auto noisy = make_scene(18, {.points = 400, .noise = 3.0}).refine({.max_variance_factor = 2.0});
  ASSERT_TRUE(clean && noisy);
  EXPECT_EQ(clean->variance_factor, 1.0);
  EXPECT_EQ(noisy->variance_factor, 2.0);
}

TEST(RefinePose, WeightsAnUncertainPointLess) {
  Scene scene = make_scene(7, {.points = 40});
  for (int i = 0; i < 10; ++i) {
    scene.observations[i].point_in_world += Eigen::Vector3d(0.1, 0.1, 0.0);
    scene.observations[i].point_covariance = 0.01 * Eigen::Matrix3d::Identity();
  }
  const auto aware = scene.refine();
  for (PoseObservation& observation : scene.observations) observation.point_covariance.setZero();
  const auto unaware = scene.refine({.rounds = 1});
  ASSERT_TRUE(aware && unaware);
  const auto error = [&](const PoseRefinement& refined) {
    return (refined.camera_from_world.translation - scene.true_camera_from_world.translation).norm();
  };
  EXPECT_LT(error(*aware), 0.5 * error(*unaware));
  EXPECT_TRUE(aware->inliers[0]);
}

TEST(RefinePose, FollowsTheHalfOfLargerWeight) {
  Scene scene = make_scene(8, {.points = 100});
  for (int i = 0; i < 50; ++i) scene.observations[i].measured.head<2>().array() += 0.8;
  const auto pull_of = [&](double weight) {
    for (int i = 0; i < 50; ++i) scene.observations[i].weight = weight;
    const auto refined = scene.refine();
    return refined ? angle_between(refined->camera_from_world.rotation, scene.true_camera_from_world.rotation) : 0.0;
  };
  EXPECT_GT(pull_of(8.0), 1.3 * pull_of(1.0));
}

TEST(RefinePose, IsInvariantToACommonWeight) {
  Scene scene = make_scene(9, {.noise = 1.0});
  const auto once = scene.refine();
  for (PoseObservation& observation : scene.observations) observation.weight = 4.0;
  const auto fourfold = scene.refine();
  ASSERT_TRUE(once && fourfold);
  EXPECT_THAT(fourfold->camera_from_world, PoseNear(once->camera_from_world, 1e-6, 1e-6));
  EXPECT_LT((fourfold->covariance - once->covariance).norm(), 1e-4 * once->covariance.norm());
  EXPECT_EQ(fourfold->inliers, once->inliers);
}

TEST(RefinePose, IgnoresTheDisparityOfAMonocularSighting) {
  Scene scene = make_scene(10, {.mono_fraction = 1.0, .noise = 1.0});
  const auto with_zero = scene.refine();
  for (PoseObservation& observation : scene.observations) {
    observation.measured.z() = std::numeric_limits<double>::quiet_NaN();
  }
  const auto with_nan = scene.refine();
  ASSERT_TRUE(with_zero && with_nan);
  EXPECT_THAT(with_nan->camera_from_world, PoseNear(with_zero->camera_from_world, 0.0, 1e-15));
}

TEST(RefinePose, IsDeterministic) {
  const Scene scene = make_scene(11, {.mono_fraction = 0.5, .noise = 1.0});
  const auto first = scene.refine();
  const auto second = scene.refine();
  ASSERT_TRUE(first && second);
  EXPECT_EQ(first->camera_from_world.rotation.coeffs(), second->camera_from_world.rotation.coeffs());
  EXPECT_EQ(first->camera_from_world.translation, second->camera_from_world.translation);
  EXPECT_EQ(first->covariance, second->covariance);
}

TEST(RefinePose, IsEmptyForFewerThanFourObservations) {
  EXPECT_FALSE(make_scene(12, {.points = 0}).refine());
  EXPECT_FALSE(make_scene(12, {.points = 3}).refine());
  EXPECT_TRUE(make_scene(12, {.points = 4}).refine());
}

TEST(RefinePose, IsEmptyForCoincidentPoints) {
  Scene scene = make_scene(13, {});
  for (PoseObservation& observation : scene.observations) observation = scene.observations.front();
  EXPECT_FALSE(scene.refine());
}

TEST(RefinePose, IsEmptyForCollinearPoints) {
  Scene scene = make_scene(14, {.prediction_metres = 0.01, .prediction_radians = 0.01});
  for (std::size_t i = 0; i < scene.observations.size(); ++i) {
    const Eigen::Vector3d point_in_camera(-1.0 + 0.02 * static_cast<double>(i), 0.3, 3.0);
    scene.observations[i].point_in_world = inverse(scene.true_camera_from_world) * point_in_camera;
    scene.observations[i].measured = scene.rig.project(point_in_camera);
  }
  EXPECT_FALSE(scene.refine());
}

TEST(RefinePose, IsEmptyWithoutConsistentObservations) {
  Scene scene = make_scene(15, {.points = 30});
  Draw draw(15);
  for (PoseObservation& observation : scene.observations) {
    observation.measured = scene.rig.project(draw.point_in_view(scene.rig));
  }
  const auto refined = scene.refine();
  EXPECT_TRUE(!refined || refined->inlier_count < 8);
}

// Squared normalised errors of repeated trials follow chi-square; the bounds hold with 99.9 %.
TEST(RefinePose, ReturnsACovarianceThatMatchesItsErrors) {
  constexpr int kTrials = 300;
  constexpr double kDegrees = 6.0 * kTrials;
  const double bound = 3.3 * std::sqrt(2.0 * kDegrees);
  EXPECT_NEAR(normalised_errors(kTrials, {.noise = 1.0}, 1.0), kDegrees, bound);
  EXPECT_NEAR(normalised_errors(kTrials, {.noise = 1.0, .point_sigma = 0.02}, 1.0), kDegrees, bound);
  EXPECT_NEAR(normalised_errors(kTrials, {.noise = 1.0}, 4.0), kDegrees, bound);
}

TEST(RefinePose, ReturnsACovarianceThatMatchesErrorsLargerThanStated) {
  constexpr int kTrials = 300;
  constexpr double kDegrees = 6.0 * kTrials;
  EXPECT_NEAR(normalised_errors(kTrials, {.points = 200, .noise = 2.0}, 1.0), kDegrees,
              3.3 * std::sqrt(2.0 * kDegrees));
}

// In mono the gates make the variances about 15 % too small.
TEST(RefinePose, ReturnsAMonoCovarianceCloseToItsErrors) {
  constexpr int kTrials = 300;
  constexpr double kDegrees = 6.0 * kTrials;
  EXPECT_NEAR(normalised_errors(kTrials, {.mono_fraction = 1.0, .noise = 1.0}, 1.0), 1.15 * kDegrees,
              3.3 * std::sqrt(2.0 * kDegrees));
}

// Accurate points with an error that is constant within each of 4 x 3 image regions, plus noise.
Scene scene_with_systematic_errors(unsigned seed, double systematic_sigma) {
  constexpr double kSharp = 0.06;  // pixels
  Scene scene = make_scene(seed, {.points = 400, .prediction_metres = 0.01, .prediction_radians = 0.003});
  Draw draw(1000 + seed);
  std::vector<Eigen::Vector3d> shared;
  for (int part = 0; part < 12; ++part) {
    shared.push_back({draw.normal(systematic_sigma), draw.normal(systematic_sigma), 0.0});
  }
  for (PoseObservation& observation : scene.observations) {
    const int column = std::clamp(static_cast<int>(4.0 * observation.measured.x() / scene.rig.width), 0, 3);
    const int row = std::clamp(static_cast<int>(3.0 * observation.measured.y() / scene.rig.height), 0, 2);
    observation.measured += shared[static_cast<std::size_t>(4 * row + column)];
    observation.measured += Eigen::Vector3d{draw.normal(kSharp), draw.normal(kSharp), draw.normal(kSharp)};
    observation.pixel_sigma = kSharp;
    observation.disparity_sigma = kSharp;
  }
  return scene;
}

TEST(RefinePose, KeepsPrecisePointsWithSystematicErrors) {
  int kept = 0, kept_by_noise = 0;
  for (unsigned seed = 30; seed < 40; ++seed) {
    const Scene scene = scene_with_systematic_errors(seed, 0.25);
    const auto refined = scene.refine();
    ASSERT_TRUE(refined);
    kept += refined->inlier_count;
    if (const auto by_noise = scene.refine(kNoiseAlone)) kept_by_noise += by_noise->inlier_count;
  }
  EXPECT_GT(kept, 0.9 * 10 * 400);
  EXPECT_GT(kept, kept_by_noise);
}

TEST(RefinePose, ReturnsACovarianceThatCoversSystematicErrors) {
  constexpr int kTrials = 50;
  double known = 0.0, by_noise = 0.0;  // mean squared normalised errors, expected six
  for (unsigned trial = 0; trial < kTrials; ++trial) {
    const Scene scene = scene_with_systematic_errors(100 + trial, 0.4);
    const auto add = [&](const std::optional<PoseRefinement>& refined, double& sum) {
      ASSERT_TRUE(refined);
      const Vector6 error = log_pose(scene.true_camera_from_world * inverse(refined->camera_from_world));
      sum += error.dot(refined->covariance.inverse() * error) / kTrials;
    };
    add(scene.refine(), known);
    add(scene.refine(kNoiseAlone), by_noise);
  }
  EXPECT_LT(known, 12.0);
  EXPECT_GT(known, 2.0) << "and not much too large";
  EXPECT_GT(by_noise, 2.0 * known);
}

TEST(RefinePose, EstimatesTheSystematicPart) {
  const auto small = scene_with_systematic_errors(7, 0.02).refine();
  const auto large = scene_with_systematic_errors(7, 0.5).refine();
  ASSERT_TRUE(small && large);
  EXPECT_LT(small->systematic_sigma, 0.15);
  EXPECT_GT(large->systematic_sigma, 0.3);
  EXPECT_LT(large->systematic_sigma, 0.8);
}

// A prior displaced from the truth by delta; sigma in metres and radians.
PosePrior prior_off(const Scene& scene, const Vector6& delta, double sigma) {
  return {exp_pose(delta) * scene.true_camera_from_world, sigma * sigma * Matrix6::Identity()};
}

const Vector6 kOff = (Vector6() << 0.02, -0.03, 0.04, 0.01, -0.02, 0.015).finished();

TEST(RefinePoseWithPrior, IsHeldByAStrongPrior) {
  const Scene scene = make_scene(40, {.noise = 1.0});
  const PosePrior prior = prior_off(scene, 0.1 * kOff, 1e-6);
  const auto refined = scene.refine_with(prior);
  ASSERT_TRUE(refined);
  EXPECT_THAT(refined->camera_from_world, PoseNear(prior.camera_from_world, 1e-6, 1e-6));
  EXPECT_GT(refined->inlier_count, 90) << "a prior causes no outliers";
}

TEST(RefinePoseWithPrior, IsHardlyMovedByAWeakPrior) {
  const Scene scene = make_scene(41, {.noise = 1.0});
  const auto alone = scene.refine();
  const auto refined = scene.refine_with(prior_off(scene, kOff, 1e3));
  ASSERT_TRUE(alone && refined);
  EXPECT_THAT(refined->camera_from_world, PoseNear(alone->camera_from_world, 1e-6, 1e-6));
  EXPECT_LT((refined->covariance - alone->covariance).norm(), 1e-6 * alone->covariance.norm());
  EXPECT_EQ(refined->inliers, alone->inliers);
}

TEST(RefinePoseWithPrior, IsBitIdenticalWithoutPrior) {
  const Scene scene = make_scene(42, {.mono_fraction = 0.5, .noise = 1.0});
  const auto alone = scene.refine();
  const auto refined = refine_pose(scene.predicted_camera_from_world, scene.rig, scene.observations, {}, std::nullopt);
  ASSERT_TRUE(alone && refined);
  EXPECT_EQ(refined->camera_from_world, alone->camera_from_world);
  EXPECT_EQ(refined->covariance, alone->covariance);
}

// Clean measurements stay in the quadratic part of the loss, so that both costs are plain sums of squares.
double cost_of(const Scene& scene, const PosePrior& prior, const Pose& camera_from_world) {
  double cost = 0.0;
  for (const PoseObservation& observation : scene.observations) {
    const Eigen::Vector3d error =
        observation.measured - scene.rig.project(camera_from_world * observation.point_in_world);
    cost += error.head<2>().squaredNorm() / std::pow(observation.pixel_sigma, 2);
    if (observation.is_stereo()) cost += std::pow(error.z() / observation.disparity_sigma, 2);
  }
  const Vector6 off = log_pose(camera_from_world * inverse(prior.camera_from_world));
  return cost + off.dot(prior.covariance.inverse() * off);
}

TEST(RefinePoseWithPrior, MinimisesTheSumOfBothCosts) {
  Scene scene = make_scene(43, {.points = 30});
  for (PoseObservation& observation : scene.observations) observation.pixel_sigma = observation.disparity_sigma = 20.0;
  PosePrior prior = prior_off(scene, 3.0 * kOff, 0.03);
  prior.covariance(0, 4) = prior.covariance(4, 0) = 0.5 * prior.covariance(0, 0);
  const auto refined = scene.refine_with(prior, {.rounds = 4, .iterations_per_round = 20});
  ASSERT_TRUE(refined);
  ASSERT_EQ(refined->inlier_count, 30);
  const double least = cost_of(scene, prior, refined->camera_from_world);
  EXPECT_LT(least, cost_of(scene, prior, scene.true_camera_from_world));
  EXPECT_LT(least, cost_of(scene, prior, prior.camera_from_world));
  for (int i = 0; i < 6; ++i) {
    for (const double step : {-1e-3, 1e-3}) {
      EXPECT_GT(cost_of(scene, prior, exp_pose(step * Vector6::Unit(i)) * refined->camera_from_world), least) << i;
    }
  }
}

TEST(RefinePoseWithPrior, AddsTheInformationOfThePrior) {
  const Scene scene = make_scene(44, {});
  const auto alone = scene.refine(kNoiseAlone);
  ASSERT_TRUE(alone);
  PosePrior prior{scene.true_camera_from_world, alone->covariance};
  const auto twice_as_sure = scene.refine_with(prior, kNoiseAlone);
  ASSERT_TRUE(twice_as_sure);
  EXPECT_LT((twice_as_sure->covariance - 0.5 * alone->covariance).norm(), 1e-6 * alone->covariance.norm());
  prior.covariance *= 1e-6;
  const auto as_the_prior = scene.refine_with(prior, kNoiseAlone);
  ASSERT_TRUE(as_the_prior);
  EXPECT_LT((as_the_prior->covariance - prior.covariance).norm(), 1e-5 * prior.covariance.norm());
}

TEST(RefinePoseWithPrior, ConstrainsTheFreeDirectionOfCollinearPoints) {
  Scene scene = make_scene(45, {.prediction_metres = 0.01, .prediction_radians = 0.01});
  for (std::size_t i = 0; i < scene.observations.size(); ++i) {
    const Eigen::Vector3d point_in_camera(-1.0 + 0.02 * static_cast<double>(i), 0.3, 3.0);
    scene.observations[i].point_in_world = inverse(scene.true_camera_from_world) * point_in_camera;
    scene.observations[i].measured = scene.rig.project(point_in_camera);
  }
  EXPECT_FALSE(scene.refine());
  const auto refined = scene.refine_with(prior_off(scene, Vector6::Zero(), 0.01));
  ASSERT_TRUE(refined);
  EXPECT_THAT(refined->camera_from_world, PoseNear(scene.true_camera_from_world, 1e-4, 1e-4));
}

TEST(RefinePoseWithPrior, IsEmptyForFewerThanFourObservations) {
  const Scene scene = make_scene(46, {.points = 3});
  EXPECT_FALSE(scene.refine_with(prior_off(scene, Vector6::Zero(), 0.01)));
}

}  // namespace
}  // namespace byre
