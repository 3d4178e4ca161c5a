#include "byre/trajectory_error.h"
#include "byre/geometry/degrees.h"

#include <cmath>
#include <numbers>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace byre {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

// A helix with slow roll at 20 Hz, without symmetry.
Trajectory helix(int samples) {
  Trajectory trajectory;
  for (int i = 0; i < samples; ++i) {
    const double angle = 0.05 * i;
    const Pose world_from_body{rotation_exp({0.3 * std::sin(0.1 * i), 0.02 * i, angle}),
                               {2.0 * std::cos(angle), 3.0 * std::sin(angle), 0.01 * i}};
    trajectory.push_back({i * milliseconds(50), world_from_body});
  }
  return trajectory;
}

Trajectory straight_line(int samples, double step_m) {
  Trajectory trajectory;
  for (int i = 0; i < samples; ++i) trajectory.push_back({i * milliseconds(100), {{1, 0, 0, 0}, {step_m * i, 0, 0}}});
  return trajectory;
}

const Pose kMotion{rotation_exp({0.4, -1.1, 0.7}), {10.0, -20.0, 5.0}};

Trajectory moved(const Trajectory& trajectory, const Pose& other_from_world, double scale) {
  Trajectory result = trajectory;
  for (StampedPose& sample : result) {
    sample.world_from_body.translation *= scale;
    sample.world_from_body = other_from_world * sample.world_from_body;
  }
  return result;
}

std::vector<PosePair> pairs_of(const Trajectory& estimate, const Trajectory& truth) {
  return associate(estimate, truth, AssociationOptions{});
}

TEST(Summarise, ReturnsStatisticsOfASmallSample) {
  const ErrorStatistics statistics = summarise({4.0, 1.0, 2.0, 3.0});
  EXPECT_DOUBLE_EQ(statistics.rmse, std::sqrt(7.5));
  EXPECT_DOUBLE_EQ(statistics.mean, 2.5);
  EXPECT_DOUBLE_EQ(statistics.median, 2.5);
  EXPECT_DOUBLE_EQ(statistics.p95, 3.85);
  EXPECT_DOUBLE_EQ(statistics.max, 4.0);
  EXPECT_EQ(statistics.count, 4);
}

TEST(Summarise, IsZeroWithoutValues) {
  EXPECT_EQ(summarise({}).count, 0);
  EXPECT_EQ(summarise({}).rmse, 0.0);
}

TEST(Associate, InterpolatesTheTruthInASmallGap) {
  Trajectory truth = straight_line(2, 1.0);
  truth[1].time = milliseconds(20);
  const Trajectory estimate = {{milliseconds(5), {}}};
  const std::vector<PosePair> pairs = pairs_of(estimate, truth);
  ASSERT_EQ(pairs.size(), 1u);
  EXPECT_NEAR(pairs[0].true_world_from_body.translation.x(), 0.25, 1e-12);
  EXPECT_EQ(pairs[0].time, milliseconds(5));
}

TEST(Associate, UsesTheNearestSampleInALargeGapIfClose) {
  const Trajectory truth = straight_line(2, 1.0);  // at 0 and 100 ms
  const Trajectory estimate = {{milliseconds(-3), {}}, {milliseconds(-2), {}}, {milliseconds(1), {}},
                               {milliseconds(50), {}}, {milliseconds(98), {}}, {milliseconds(103), {}}};
  const std::vector<PosePair> pairs = pairs_of(estimate, truth);
  ASSERT_EQ(pairs.size(), 3u);
  EXPECT_EQ(pairs[0].time, milliseconds(-2));
  EXPECT_EQ(pairs[1].true_world_from_body.translation.x(), 0.0);
  EXPECT_EQ(pairs[2].true_world_from_body.translation.x(), 1.0);
}

TEST(Associate, InterpolatesAcrossTheGapOnRequest) {
  const Trajectory truth = straight_line(2, 1.0);
  AssociationOptions options;
  options.max_gap = milliseconds(100);
  const std::vector<PosePair> pairs = associate({{milliseconds(50), {}}}, truth, options);
  ASSERT_EQ(pairs.size(), 1u);
  EXPECT_NEAR(pairs[0].true_world_from_body.translation.x(), 0.5, 1e-12);
}

TEST(Associate, AddsTheTimeOffsetToTheTruth) {
  Trajectory late_truth = helix(100);
  for (StampedPose& sample : late_truth) sample.time += milliseconds(30);
  AssociationOptions options;
  options.time_offset = milliseconds(-30);
  const std::vector<PosePair> pairs = associate(helix(100), late_truth, options);
  ASSERT_EQ(pairs.size(), 100u);
  EXPECT_LT(absolute_trajectory_error(pairs, Scale::fixed)->translation.max, 1e-9);
}

TEST(Associate, IsEmptyForEmptyTrajectories) {
  EXPECT_TRUE(pairs_of({}, helix(10)).empty());
  EXPECT_TRUE(pairs_of(helix(10), {}).empty());
}

TEST(AbsoluteTrajectoryError, IsZeroForATransformedCopy) {
  const auto error = absolute_trajectory_error(pairs_of(moved(helix(200), kMotion, 1.0), helix(200)), Scale::fixed);
  ASSERT_TRUE(error.has_value());
  EXPECT_LT(error->translation.max, 1e-9);
  EXPECT_LT(error->rotation.max, 1e-6);
  EXPECT_EQ(error->errors.size(), 200u);
}

TEST(AbsoluteTrajectoryError, IsZeroForAScaledCopyIfTheScaleIsFree) {
  const std::vector<PosePair> pairs = pairs_of(moved(helix(200), kMotion, 0.5), helix(200));
  const auto free = absolute_trajectory_error(pairs, Scale::free);
  const auto fixed = absolute_trajectory_error(pairs, Scale::fixed);
  ASSERT_TRUE(free && fixed);
  EXPECT_NEAR(free->truth_from_estimate.scale, 2.0, 1e-9);
  EXPECT_LT(free->translation.max, 1e-9);
  EXPECT_GT(fixed->translation.rmse, 0.5);
}

TEST(AbsoluteTrajectoryError, IsTheShiftWithoutAlignment) {
  const Pose shift{rotation_exp({10.0 * kDegree, 0.0, 0.0}), Eigen::Vector3d::Zero()};
  Trajectory estimate = straight_line(5, 1.0);
  for (StampedPose& sample : estimate) sample.world_from_body = sample.world_from_body * shift;
  for (StampedPose& sample : estimate) sample.world_from_body.translation += Eigen::Vector3d(0.0, 3.0, 4.0);
  const AbsoluteTrajectoryError error =
      absolute_trajectory_error(pairs_of(estimate, straight_line(5, 1.0)), Similarity{});
  EXPECT_NEAR(error.translation.rmse, 5.0, 1e-12);
  EXPECT_NEAR(error.translation.max, 5.0, 1e-12);
  EXPECT_NEAR(error.rotation.mean, 10.0, 1e-9);
}

// Corners of a square, alternately raised and lowered: no rigid motion reduces the error.
TEST(AbsoluteTrajectoryError, AgreesWithAHandComputedCase) {
  const double height = 0.1;
  const Trajectory truth = {{seconds(0), {{1, 0, 0, 0}, {1, 1, 0}}},
                            {seconds(1), {{1, 0, 0, 0}, {-1, 1, 0}}},
                            {seconds(2), {{1, 0, 0, 0}, {-1, -1, 0}}},
                            {seconds(3), {{1, 0, 0, 0}, {1, -1, 0}}}};
  Trajectory estimate = truth;
  for (std::size_t i = 0; i < 4; ++i) estimate[i].world_from_body.translation.z() = i % 2 == 0 ? height : -height;
  const auto error = absolute_trajectory_error(pairs_of(estimate, truth), Scale::fixed);
  ASSERT_TRUE(error.has_value());
  EXPECT_NEAR(error->translation.rmse, height, 1e-12);
  EXPECT_NEAR(error->translation.max, height, 1e-12);
}

TEST(AbsoluteTrajectoryError, IsEmptyWithoutADeterminedAlignment) {
  const Trajectory line = straight_line(10, 1.0);
  EXPECT_FALSE(absolute_trajectory_error(pairs_of(line, line), Scale::fixed).has_value());
  EXPECT_FALSE(absolute_trajectory_error({}, Scale::fixed).has_value());
}

TEST(RelativePoseError, IsIndependentOfTheFrameOfTheEstimate) {
  Trajectory estimate = helix(200);
  for (std::size_t i = 0; i < estimate.size(); ++i) {
    estimate[i].world_from_body.translation.x() += 0.01 * std::sin(static_cast<double>(i));
  }
  const std::vector<PosePair> here = pairs_of(estimate, helix(200));
  const std::vector<PosePair> elsewhere = pairs_of(moved(estimate, kMotion, 1.0), helix(200));
  const RelativePoseError error = relative_pose_error_by_frame(here, 1.0);
  EXPECT_GT(error.translation.rmse, 1e-3);
  EXPECT_NEAR(error.translation.rmse, relative_pose_error_by_frame(elsewhere, 1.0).translation.rmse, 1e-9);
  EXPECT_NEAR(error.rotation.max, relative_pose_error_by_frame(elsewhere, 1.0).rotation.max, 1e-6);
}

TEST(RelativePoseError, DependsOnTheBodyFrame) {
  Trajectory estimate = helix(200);
  const Pose body_from_camera{rotation_exp({0.0, 0.0, 1.5}), {0.1, 0.0, 0.0}};
  for (StampedPose& sample : estimate) sample.world_from_body = sample.world_from_body * body_from_camera;
  const RelativePoseError error = relative_pose_error_by_time(pairs_of(estimate, helix(200)), seconds(1), 1.0);
  EXPECT_GT(error.translation.rmse, 0.1);
  EXPECT_GT(error.rotation.rmse, 1.0);
}

TEST(RelativePoseError, IsZeroForAScaledCopyWithItsScale) {
  const std::vector<PosePair> pairs = pairs_of(moved(helix(200), kMotion, 0.5), helix(200));
  EXPECT_LT(relative_pose_error_by_time(pairs, seconds(1), 2.0).translation.max, 1e-9);
  EXPECT_GT(relative_pose_error_by_time(pairs, seconds(1), 1.0).translation.rmse, 0.1);
}

// Each step of 1 m is estimated as 1.1 m: a relative error of 0.1.
TEST(RelativePoseError, AgreesWithAHandComputedCase) {
  const std::vector<PosePair> pairs = pairs_of(straight_line(31, 1.1), straight_line(31, 1.0));
  const RelativePoseError by_frame = relative_pose_error_by_frame(pairs, 1.0);
  EXPECT_NEAR(by_frame.translation.rmse, 0.1, 1e-12);
  EXPECT_EQ(by_frame.translation.count, 30);
  const RelativePoseError by_time = relative_pose_error_by_time(pairs, seconds(1), 1.0);
  EXPECT_NEAR(by_time.translation.rmse, 1.0, 1e-12);
  EXPECT_EQ(by_time.translation.count, 21);
  const RelativePoseError by_distance = relative_pose_error_by_distance(pairs, 3.0, 1.0);
  EXPECT_NEAR(by_distance.translation.rmse, 0.3, 1e-12);
  EXPECT_EQ(by_distance.translation.count, 28);
  EXPECT_NEAR(by_distance.rotation.max, 0.0, 1e-9);
}

TEST(RelativePoseError, ReturnsRotationInDegrees) {
  Trajectory estimate = straight_line(11, 1.0);
  for (std::size_t i = 0; i < estimate.size(); ++i) {
    estimate[i].world_from_body.rotation = rotation_exp({2.0 * kDegree * static_cast<double>(i), 0.0, 0.0});
  }
  const std::vector<PosePair> pairs = pairs_of(estimate, straight_line(11, 1.0));
  EXPECT_NEAR(relative_pose_error_by_frame(pairs, 1.0).rotation.rmse, 2.0, 1e-9);
  EXPECT_NEAR(relative_pose_error_by_time(pairs, milliseconds(500), 1.0).rotation.rmse, 10.0, 1e-9);
}

TEST(RelativePoseError, OmitsIntervalsWithoutAPair) {
  const std::vector<PosePair> pairs = pairs_of(straight_line(5, 0.86), straight_line(5, 0.86));
  EXPECT_EQ(relative_pose_error_by_distance(pairs, 1.0, 1.0).translation.count, 0);
  EXPECT_EQ(relative_pose_error_by_time(pairs, seconds(1), 1.0).translation.count, 0);
  EXPECT_EQ(relative_pose_error_by_frame({}, 1.0).translation.count, 0);
  EXPECT_EQ(relative_pose_error_by_time({}, seconds(1), 1.0).translation.count, 0);
}

TEST(RelativePoseError, ByDistanceAcceptsAStop) {
  Trajectory truth;
  for (int i = 0; i < 30; ++i) {
    const double x = 0.1 * (i < 5 ? i : std::max(5, i - 10));
    truth.push_back({i * milliseconds(100), {{1, 0, 0, 0}, {x, 0, 0}}});
  }
  EXPECT_EQ(relative_pose_error_by_distance(pairs_of(truth, truth), 0.95, 1.0).translation.count, 21);
}

TEST(PathLength, SumsTheSteps) {
  EXPECT_NEAR(path_length(straight_line(11, 0.5)), 5.0, 1e-12);
  EXPECT_EQ(path_length({}), 0.0);
}

std::vector<Timestamp> times_of(const Trajectory& trajectory) {
  std::vector<Timestamp> times;
  for (const StampedPose& sample : trajectory) times.push_back(sample.time);
  return times;
}

TEST(CoverageOfFrames, CountsFramesWithoutAPose) {
  Trajectory estimate = helix(100);
  estimate.erase(estimate.begin() + 20, estimate.begin() + 45);
  estimate.front().time += std::chrono::microseconds(3);  // rounding to six digits
  const Coverage coverage = coverage_of_frames(estimate, times_of(helix(100)));
  EXPECT_EQ(coverage.expected, 100);
  EXPECT_EQ(coverage.with_pose, 75);
  EXPECT_DOUBLE_EQ(coverage.share(), 0.75);
}

TEST(CoverageOfFrames, IsEmptyForAnotherClock) {
  Trajectory estimate = helix(100);
  for (StampedPose& sample : estimate) sample.time += seconds(1000);
  EXPECT_EQ(coverage_of_frames(estimate, times_of(helix(100))).with_pose, 0);
  EXPECT_EQ(coverage_of_frames(estimate, {}).share(), 0.0);
}

TEST(CoverageOfSpan, CountsALateStartAndAGap) {
  Trajectory estimate = helix(101);
  estimate.erase(estimate.begin() + 50, estimate.begin() + 60);
  estimate.erase(estimate.begin(), estimate.begin() + 10);
  const std::optional<Coverage> coverage = coverage_of_span(estimate, helix(101), Timestamp(0));
  ASSERT_TRUE(coverage.has_value());
  EXPECT_EQ(coverage->expected, 101);
  EXPECT_EQ(coverage->with_pose, 81);
}

TEST(CoverageOfSpan, IgnoresPosesOutsideTheTruth) {
  const Trajectory truth = helix(51);
  EXPECT_EQ(coverage_of_span(helix(101), truth, Timestamp(0))->share(), 1.0);
  EXPECT_EQ(coverage_of_span(helix(51), truth, milliseconds(1250))->with_pose, 26);
  EXPECT_FALSE(coverage_of_span(helix(1), truth, Timestamp(0)).has_value());
  EXPECT_FALSE(coverage_of_span(truth, {}, Timestamp(0)).has_value());
}

}  // namespace
}  // namespace byre
