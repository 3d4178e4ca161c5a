#include "byre/geometry/evaluation/map_frame_error.h"

#include <cmath>

#include <gtest/gtest.h>

namespace byre {
namespace {

Pose pose_at_second(double x) {
  return {rotation_exp({0.0, 0.0, 0.1 * x}), {x, 0.1 * x * x, 0.0}};
}

Trajectory poses_of_map(int count) {
  Trajectory poses;
  for (int i = 0; i < count; ++i) poses.push_back({from_seconds(i), pose_at_second(i)});
  return poses;
}

const Pose kTurnedTruthFromMap{rotation_exp({0.0, 0.0, 1.0}), {5.0, 6.0, 7.0}};

Trajectory true_path() {
  Trajectory result;
  for (int i = 0; i < 9; ++i) result.push_back({from_seconds(0.5 * i), kTurnedTruthFromMap * pose_at_second(0.5 * i)});
  return result;
}

TEST(MapAlignment, UsesPosesOfTheMap) {
  const MapAlignment alignment = align_to_truth(poses_of_map(4), Scale::fixed, true_path());
  EXPECT_EQ(alignment.poses, 4);
  EXPECT_NEAR(log_pose(inverse(alignment.truth_from_map.target_from_source) * kTurnedTruthFromMap).norm(), 0.0, 1e-9);
}

// Millimetres of noise across a straight path leave the rotation about it arbitrary.
TEST(MapAlignment, UsesOrientationsOnAStraightPath) {
  Trajectory truth, estimate;
  for (int i = 0; i < 20; ++i) {
    const Pose true_pose{rotation_exp({0.02, 0.01, 0.0}), {0.5 * i, 0.0, 0.0}};
    Pose estimated = inverse(kTurnedTruthFromMap) * true_pose;
    estimated.translation += 0.003 * Eigen::Vector3d(0.0, std::sin(2.0 * i), std::cos(3.0 * i));
    truth.push_back({from_seconds(i), true_pose});
    estimate.push_back({from_seconds(i), estimated});
  }
  const MapAlignment alignment = align_to_truth(estimate, Scale::fixed, truth);
  const Pose error = inverse(alignment.truth_from_map.target_from_source) * kTurnedTruthFromMap;
  EXPECT_LT(rotation_log(error.rotation).norm(), 0.001);
}

TEST(MapAlignment, IsEmptyIfTheTruthCoversTooFewPoses) {
  EXPECT_EQ(align_to_truth(poses_of_map(2), Scale::fixed, true_path()).poses, 0);
  EXPECT_EQ(align_to_truth(poses_of_map(4), Scale::fixed, {}).poses, 0);
}

TEST(ErrorsInMap, AreBodyMotionsFromEstimateToTruth) {
  Vector6 delta;
  delta << 0.01, -0.02, 0.03, 0.1, 0.2, -0.1;
  const Trajectory estimate = {{from_seconds(0.5), pose_at_second(0.5)},
                               {from_seconds(1.0), pose_at_second(1.0) * inverse(exp_pose(delta))},
                               {from_seconds(60.0), pose_at_second(2.0)}};
  const MapAlignment alignment{{1.0, kTurnedTruthFromMap}, 4};
  const std::vector<PoseError> errors = errors_in_map(estimate, true_path(), alignment);
  ASSERT_EQ(errors.size(), 2u) << "the last pose has no truth";
  EXPECT_NEAR(errors[0].delta.norm(), 0.0, 1e-9);
  EXPECT_EQ(errors[1].time, from_seconds(1.0));
  EXPECT_NEAR((errors[1].delta - delta).norm(), 0.0, 1e-9);
  EXPECT_NEAR(errors[1].position(), 0.01 * std::sqrt(14.0), 1e-9);
  EXPECT_EQ(find_error(errors, from_seconds(1.0)), &errors[1]);
  EXPECT_EQ(find_error(errors, from_seconds(0.75)), nullptr);
  EXPECT_EQ(find_error(errors, from_seconds(60.0)), nullptr);
  EXPECT_NEAR(position_statistics(errors).max, errors[1].position(), 1e-12);
  EXPECT_NEAR(rotation_statistics(errors).max, 0.1 * std::sqrt(6.0) * 180.0 / 3.14159265358979, 1e-6);
}

// A map distorted in scale by 10 %, as by a wrong baseline, and a mission within centimetres of it.
TEST(ErrorsBesideMap, ExcludeTheErrorOfTheMap) {
  Trajectory map_path, mission, path;
  for (int i = 0; i <= 20; ++i) {
    const double x = i;
    path.push_back({from_seconds(i), {Eigen::Quaterniond::Identity(), {x, 0.1 * x * x, 0.0}}});
    map_path.push_back(
        {from_seconds(i), {Eigen::Quaterniond::Identity(), 1.1 * path.back().world_from_body.translation}});
    const Eigen::Vector3d aside = Eigen::Vector3d(0.0, 0.0, 0.03);
    mission.push_back(
        {from_seconds(i), {Eigen::Quaterniond::Identity(), map_path.back().world_from_body.translation + aside}});
  }
  const MapAlignment alignment = align_to_truth(map_path, Scale::fixed, path);
  EXPECT_GT(position_statistics(errors_in_map(mission, path, alignment)).max, 0.5);
  EXPECT_NEAR(position_statistics(errors_of_map(alignment)).rmse,
              position_statistics(errors_in_map(map_path, path, alignment)).rmse, 1e-9);
  const std::vector<PoseError> errors = errors_relative_to_map(mission, path, alignment);
  ASSERT_EQ(errors.size(), mission.size());
  EXPECT_NEAR(position_statistics(errors).max, 0.03, 1e-9);
}

TEST(ErrorsBesideMap, AreLimitedToPlacesOfTheMap) {
  const MapAlignment alignment = align_to_truth(poses_of_map(4), Scale::fixed, true_path());
  const Trajectory elsewhere = {{from_seconds(0.0), {Eigen::Quaterniond::Identity(), {50.0, 0.0, 0.0}}}};
  EXPECT_EQ(errors_relative_to_map(elsewhere, elsewhere, alignment).size(), 0u);
  EXPECT_EQ(errors_relative_to_map(true_path(), true_path(), {}).size(), 0u) << "the error of the map is unknown";
}

}  // namespace
}  // namespace byre
