#include "byre/slam/frame/focal_check.h"

#include "byre/simulation/simulated_trajectory_scene.h"

#include <random>

#include <gtest/gtest.h>

namespace byre {
namespace {

// Points at 2 to 8 m, seen with the rig's focal length times this factor.
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

FocalCheck checked(double focal_factor, double noise_pixels, unsigned seed) {
  FocalCheck check;
  for (unsigned frame = 0; frame < 3; ++frame) {
    const auto observations = seen_with(focal_factor, noise_pixels, 10 * seed + frame);
    const auto refined = refine_pose({}, simulated_rig(), observations, {});
    if (!refined) continue;
    const auto evidence = compare_focal_lengths(refined->camera_from_world, simulated_rig(), observations);
    if (evidence) check.note(*evidence);
  }
  return check;
}

TEST(FocalCheck, AcceptsACorrectFocalLength) {
  for (unsigned seed = 0; seed < 5; ++seed) {
    const FocalCheck sound = checked(1.0, 0.4, seed), worn = checked(1.004, 0.4, seed),
                     blurred = checked(1.0, 3.0, seed);
    EXPECT_NEAR(sound.error(), 0.0, 0.003);
    EXPECT_LT(std::abs(worn.error()), 0.01) << "error of a worn calibration";
    EXPECT_FALSE(sound.is_off() || worn.is_off() || blurred.is_off());
  }
}

TEST(FocalCheck, MeasuresTooLongAndTooShortFocalLengths) {
  for (unsigned seed = 0; seed < 5; ++seed) {
    const FocalCheck too_long = checked(1.0 / 1.05, 0.4, seed), too_short = checked(1.0 / 0.95, 0.4, seed);
    EXPECT_GT(too_long.error(), 0.03);
    EXPECT_LT(too_short.error(), -0.03);
    EXPECT_TRUE(too_long.is_off() && too_short.is_off());
  }
}

TEST(FocalCheck, IsEmptyWithoutFramesAndForFewPoints) {
  FocalCheck check;
  EXPECT_EQ(check.error(), 0.0);
  check.note({100.0, 500.0, 900.0, 20.0});
  EXPECT_EQ(check.error(), 0.0);
  EXPECT_FALSE(check.is_off());
  for (int frame = 0; frame < 2; ++frame) {
    check.note({100.0, 500.0, 900.0, 100.0});
    EXPECT_FALSE(check.is_off()) << "one view may be of a plane";
  }
  check.note({100.0, 500.0, 900.0, 100.0});
  EXPECT_TRUE(check.is_off());
}

TEST(FocalCheck, ReportsOnlySignificantErrors) {
  FocalCheck check;
  check.note({950.0, 900.0, 1050.0, 100.0});  // 9 square pixels per point: a blurred frame
  EXPECT_GT(std::abs(check.error()), 0.01);
  EXPECT_LT(std::abs(check.sigmas()), 3.0);
  EXPECT_FALSE(check.is_off());
}

// Error of 0.008 at four sigmas: below the bound, above half of it.
TEST(FocalCheck, KeepsAnErrorUntilItIsClearlyGone) {
  const FocalEvidence off{500.0, 100.0, 100.0, 100.0}, doubtful{364.0, 100.0, 236.0, 100.0};
  const FocalEvidence clear{300.0, 100.0, 299.0, 100.0};
  const auto note = [](FocalCheck& check, const FocalEvidence& evidence) {
    for (int frame = 0; frame < 40; ++frame) check.note(evidence);
    return check.is_off();
  };
  FocalCheck check;
  EXPECT_FALSE(note(check, doubtful));
  EXPECT_TRUE(note(check, off));
  EXPECT_TRUE(note(check, doubtful));
  EXPECT_FALSE(note(check, clear));
  EXPECT_FALSE(note(check, doubtful));
}

TEST(FocalCheck, EvaluatesTheFirstFramesThenOccasionalOnes) {
  FocalCheck check;
  int asked = 0;
  for (int frame = 0; frame < 81; ++frame) {
    if (!check.is_due()) continue;
    ++asked;
    check.note({900.0, 100.0, 900.0, 100.0});
  }
  EXPECT_EQ(asked, 5 + 4);
}

TEST(FocalCheck, RequiresEnoughPointsForAPose) {
  const auto observations = seen_with(1.0, 0.0, 1);
  EXPECT_FALSE(compare_focal_lengths({}, simulated_rig(), std::span(observations).first(2)));
}

}  // namespace
}  // namespace byre
