#include "byre/optimise/calibration_covariance.h"

#include "byre/geometry/calibration_scene.h"
#include "byre/optimise/bundle_scene.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace byre {
namespace {

constexpr double kRobustWidth = 2.0;  // sigmas

// A stereo pair in straight motion, with nothing fixed. Most points are too distant for a depth.
BundleProblem drive_towards_far_points(std::uint64_t seed, const CalibrationSensitivity& sensitivity) {
  constexpr int kPoses = 10, kNearPoints = 60, kFarPoints = 200;
  Draw draw(seed);
  BundleProblem problem;
  problem.rigs = {sensitivity.rig()};
  for (int i = 0; i < kPoses; ++i) {
    problem.poses.push_back({{Eigen::Quaterniond::Identity(), {0.0, 0.0, -0.2 * i}}, 0, false});
  }
  for (int i = 0; i < kNearPoints + kFarPoints; ++i) {
    const double depth = i < kNearPoints ? draw.uniform(4.0, 9.0) : draw.uniform(1e4, 5e4);
    problem.points.push_back({{draw.uniform(-0.4, 0.4) * depth, draw.uniform(-0.3, 0.3) * depth, depth}, false});
    for (int pose = 0; pose < kPoses; ++pose) {
      const Eigen::Vector3d point_in_camera =
          problem.poses[pose].camera_from_world * problem.points.back().position_in_world;
      BundleObservation seen{.pose = pose, .point = i, .measured = problem.rigs[0].project(point_in_camera)};
      seen.pixel_sigma = 0.1;
      if (i < kNearPoints) seen.disparity_sigma = 0.1;
      problem.observations.push_back(seen);
    }
  }
  problem.calibration = BundleCalibration{&sensitivity, 0, CalibrationVector::Zero(), CalibrationMatrix::Identity()};
  return problem;
}

TEST(CalibrationInformation, IsPositiveDefiniteForDistantPoints) {
  const CalibrationSensitivity sensitivity(scene_calibration());
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    const auto information = calibration_information(drive_towards_far_points(seed, sensitivity), kRobustWidth);
    ASSERT_TRUE(information) << "seed " << seed;
    const Eigen::SelfAdjointEigenSolver<CalibrationMatrix> directions(*information);
    EXPECT_GT(directions.eigenvalues()[0], 0.99) << "prior information, seed " << seed;
    EXPECT_GT(directions.eigenvalues()[kCalibrationParameters - 1], 100.0)
        << "information of observations, seed " << seed;
  }
}

TEST(CalibrationInformation, IsThePriorWithoutObservations) {
  const CalibrationSensitivity sensitivity(scene_calibration());
  BundleProblem problem = drive_towards_far_points(1, sensitivity);
  problem.observations.clear();
  const auto information = calibration_information(problem, kRobustWidth);
  ASSERT_TRUE(information);
  EXPECT_TRUE(information->isApprox(CalibrationMatrix::Identity()));
}

}  // namespace
}  // namespace byre
