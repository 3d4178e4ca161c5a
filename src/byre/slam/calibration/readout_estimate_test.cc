#include "byre/slam/calibration/readout_estimate.h"

#include "byre/slam/calibration/rolling_scene.h"

#include <gtest/gtest.h>

namespace byre {
namespace {

constexpr double kInformation = 1e6;  // 1 / s^2, information of a frame: a sigma of 1 ms
constexpr int kPoints = 300;          // points of a frame; 20 ms move each by more than a sigma

// Readout time after frames that all measure this change, seconds.
double after(ReadoutEstimator& estimator, double change, int frames) {
  for (int i = 0; i < frames; ++i) estimator.note({kInformation, kInformation * change, kPoints});
  return estimator.readout_time();
}

TEST(ReadoutEstimator, ConvergesToTheMeasuredTime) {
  ReadoutEstimator estimator(0.0);
  EXPECT_NEAR(after(estimator, 0.02, 32), 0.02, 1e-9);
}

TEST(ReadoutEstimator, RequiresEnoughFrames) {
  ReadoutEstimator estimator(0.0);
  EXPECT_EQ(after(estimator, 0.02, 31), 0.0);
}

TEST(ReadoutEstimator, IgnoresSmallTimesThatCalibrationErrorsExplain) {
  ReadoutEstimator estimator(0.0);
  EXPECT_EQ(after(estimator, 0.004, 400), 0.0);
}

TEST(ReadoutEstimator, IgnoresWeakEvidence) {
  ReadoutEstimator estimator(0.0);
  constexpr int kManyPoints = 30000;
  for (int i = 0; i < 400; ++i) estimator.note({kInformation, kInformation * 0.02, kManyPoints});
  EXPECT_EQ(estimator.readout_time(), 0.0);
}

TEST(ReadoutEstimator, RefinesAnEarlierEstimate) {
  ReadoutEstimator estimator(0.02);
  EXPECT_EQ(after(estimator, 0.0005, 400), 0.02);
  EXPECT_GT(after(estimator, 0.004, 64 + 400), 0.021);
}

TEST(ReadoutEstimator, DropsAnEstimateNearZero) {
  ReadoutEstimator estimator(0.008);
  EXPECT_EQ(after(estimator, -0.0075, 32), 0.0);
}

TEST(ReadoutEstimator, IgnoresMotionDependentErrors) {
  ReadoutEstimator estimator(0.0);
  for (int i = 0; i < 400; ++i) {
    const double change = i / 8 % 2 == 0 ? 0.1 : -0.08;  // 0.01 on average, due to another error
    estimator.note({kInformation, kInformation * change, kPoints});
  }
  EXPECT_EQ(estimator.readout_time(), 0.0);
}

TEST(ReadoutEstimator, RejectsImplausiblyLongTimes) {
  ReadoutEstimator estimator(0.0);
  EXPECT_EQ(after(estimator, 0.2, 400), 0.0);
}

// Readout time measured on true points and poses, seconds, with an assumed one of zero.
double change_told_by(const SimulatedMission& mission) {
  const MapGraph map = true_map(mission, 4, Origin::online);
  const MapView view{nullptr, map};
  ReadoutEvidence sum;
  for (std::size_t i = 1; i + 1 < mission.frames.size(); ++i) {
    const auto tracked =
        track(mission.frames[i], true_camera_from_world(mission, i), mission.rig, view, map.point_ids(), {});
    if (tracked) sum += readout_evidence(mission.frames[i], mission.rig, *tracked, view, true_velocity(mission, i));
  }
  return sum.right_side / sum.information;
}

TEST(ReadoutEvidence, MeasuresTheReadoutTime) {
  SimulationOptions options;
  options.pixel_sigma = 0.2;
  const SimulatedMission mission =
      simulate_mission(simulated_rig(), figure_eight_trajectory(80, 20.0, 4.0, 0.5), options);
  EXPECT_NEAR(change_told_by(rolling(mission, 0.0)), 0.0, 5e-4);
  EXPECT_NEAR(change_told_by(rolling(mission, 0.005)), 0.005, 1e-3);
}

TEST(ReadoutEvidence, IsEmptyWithoutRotation) {
  const SimulatedMission mission =
      rolling(simulate_mission(simulated_rig(), figure_eight_trajectory(20, 20.0, 4.0, 0.1), {}), 0.005);
  const MapGraph map = true_map(mission, 4, Origin::online);
  const MapView view{nullptr, map};
  constexpr std::size_t kFrame = 10;
  const auto tracked =
      track(mission.frames[kFrame], true_camera_from_world(mission, kFrame), mission.rig, view, map.point_ids(), {});
  ASSERT_TRUE(tracked);
  Vector6 velocity = Vector6::Zero();
  velocity[2] = -1.0;
  EXPECT_EQ(readout_evidence(mission.frames[kFrame], mission.rig, *tracked, view, velocity).information, 0.0);
  velocity[4] = 0.5;
  EXPECT_GT(readout_evidence(mission.frames[kFrame], mission.rig, *tracked, view, velocity).information, 0.0);
}

}  // namespace
}  // namespace byre
