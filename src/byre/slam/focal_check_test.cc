#include "byre/slam/focal_check.h"

#include "byre/simulation/simulated_trajectory.h"

#include <random>

#include <gtest/gtest.h>

namespace byre {
namespace {

// Points between 2 and 8 m as a camera sees them whose focal length is so many times as long as it is said to be.
std::vector<PoseObservation> seen_with(double focal_factor, double noise_pixels, unsigned seed) {
  Rig camera = simulated_rig();
  camera.focal *= focal_factor;
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> any(0.0, 1.0);
  std::normal_distribution<double> normal(0.0, noise_pixels);
  std::vector<PoseObservation> observations;
  for (int i = 0; i < 200; ++i) {
    const Eigen::Vector2d pixel(camera.width * any(random), camera.height * any(random));
    PoseObservation observation;
    observation.point_in_world = (2.0 + 6.0 * any(random)) * camera.ray(pixel);
    observation.measured = camera.project(observation.point_in_world);
    for (double& coordinate : observation.measured) coordinate += normal(random);
    observation.pixel_sigma = 0.5;
    observation.disparity_sigma = 0.5;
    observations.push_back(observation);
  }
  return observations;
}

double error_of(double focal_factor, unsigned seed) {
  FocalCheck check({});
  for (unsigned frame = 0; frame < 3; ++frame) {
    const auto observations = seen_with(focal_factor, 0.4, 10 * seed + frame);
    const auto evidence = weigh_focal_lengths({}, simulated_rig(), observations, {});
    if (evidence) check.note(*evidence, observations.size());
  }
  return check.error();
}

TEST(FocalCheck, LeavesARightFocalLengthAlone) {
  for (unsigned seed = 0; seed < 5; ++seed) {
    EXPECT_NEAR(error_of(1.0, seed), 0.0, 0.003);
    EXPECT_LT(std::abs(error_of(1.004, seed)), 0.01) << "as a worn calibration has it";
  }
}

TEST(FocalCheck, TellsThatItIsTooLongOrTooShort) {
  for (unsigned seed = 0; seed < 5; ++seed) {
    EXPECT_GT(error_of(1.0 / 1.05, seed), 0.03);
    EXPECT_LT(error_of(1.0 / 0.95, seed), -0.03);
  }
}

TEST(FocalCheck, SaysNothingBeforeAnythingWasSeenAndOfFewPoints) {
  FocalCheck check({});
  EXPECT_EQ(check.error(), 0.0);
  check.note({1.0, 5.0, 9.0}, 20);
  EXPECT_EQ(check.error(), 0.0);
  EXPECT_FALSE(check.is_off());
  check.note({1.0, 5.0, 9.0}, 100);
  EXPECT_TRUE(check.is_off());
}

TEST(FocalCheck, AsksTheFirstFramesThenNowAndThen) {
  FocalCheckOptions options;
  options.asked_first = 2;
  options.asked_every = 10;
  FocalCheck check(options);
  int asked = 0;
  for (int frame = 0; frame < 41; ++frame) {
    if (!check.is_due()) continue;
    ++asked;
    check.note({9.0, 1.0, 9.0}, 100);
  }
  EXPECT_EQ(asked, 2 + 4);
}

TEST(FocalCheck, NeedsPointsEnoughForAPose) {
  const auto observations = seen_with(1.0, 0.0, 1);
  EXPECT_FALSE(weigh_focal_lengths({}, simulated_rig(), std::span(observations).first(2), {}));
}

}  // namespace
}  // namespace byre
