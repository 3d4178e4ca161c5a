#include "byre/optimise/pose_expansion.h"

#include "byre/optimise/optimise_scene.h"
#include "byre/optimise/robust_error.h"
#include "byre/pose.h"

#include <vector>

#include <gtest/gtest.h>
#include <hwy/targets.h>

namespace byre {
namespace {

constexpr double kWidth = 1.5;

std::vector<WeightedPoint> some_points(int count, const Pose& camera_from_world) {
  Draw draw(7);
  std::vector<WeightedPoint> points;
  for (int i = 0; i < count; ++i) {
    const Eigen::Vector3d point_in_camera = draw.point_in_view(stereo_rig());
    WeightedPoint& point = points.emplace_back();
    point.point_in_world = inverse(camera_from_world) * point_in_camera;
    point.measured = stereo_rig().project(point_in_camera) + draw.normal3(2.0);
    const Eigen::Matrix3d root = Eigen::Matrix3d::Identity() + 0.1 * Eigen::Matrix3d::Ones() * draw.uniform(0.0, 1.0);
    point.information = root * root.transpose();
    if (i % 3 == 0) point.information.row(2).setZero(), point.information.col(2).setZero();
    point.weight = draw.uniform(0.5, 4.0);
  }
  return points;
}

WeightedPoints side_by_side(const std::vector<WeightedPoint>& points) {
  WeightedPoints packed;
  for (const WeightedPoint& point : points) packed.add(point);
  return packed;
}

// Reference implementation, point by point.
PoseExpansion expand_one_by_one(const std::vector<WeightedPoint>& points, const Pose& camera_from_world) {
  PoseExpansion sum;
  for (const WeightedPoint& point : points) {
    const Eigen::Vector3d point_in_camera = camera_from_world * point.point_in_world;
    const Eigen::Vector3d error = point.measured - stereo_rig().project(point_in_camera);
    const double squared_error = error.dot(point.information * error);
    Eigen::Matrix<double, 3, 6> by_pose;
    by_pose << Eigen::Matrix3d::Identity(), -skew(point_in_camera);
    by_pose = stereo_rig().projection_jacobian(point_in_camera) * by_pose;
    const double weight = point.weight * huber_weight(squared_error, kWidth);
    sum.cost += point.weight * huber_cost(squared_error, kWidth);
    sum.normal_matrix += weight * by_pose.transpose() * point.information * by_pose;
    sum.descent += weight * by_pose.transpose() * point.information * error;
  }
  return sum;
}

void expect_alike(const PoseExpansion& a, const PoseExpansion& b) {
  EXPECT_NEAR(a.cost, b.cost, 1e-9 * b.cost);
  EXPECT_LE((a.normal_matrix - b.normal_matrix).norm(), 1e-9 * b.normal_matrix.norm());
  EXPECT_LE((a.descent - b.descent).norm(), 1e-9 * b.descent.norm());
}

const Pose kPose{rotation_exp({0.1, -0.2, 0.3}), {1.0, 2.0, -0.5}};

TEST(PoseCostExpansion, IsTheSumOfItsPoints) {
  for (const int count : {1, 3, 4, 5, 102}) {
    const std::vector<WeightedPoint> points = some_points(count, kPose);
    expect_alike(side_by_side(points).expand(stereo_rig(), kPose, kWidth), expand_one_by_one(points, kPose));
  }
}

TEST(PoseCostExpansion, IsZeroWithoutPoints) {
  WeightedPoints points = side_by_side(some_points(9, kPose));
  points.clear();
  const PoseExpansion nothing = points.expand(stereo_rig(), kPose, kWidth);
  EXPECT_EQ(nothing.cost, 0.0);
  EXPECT_EQ(nothing.normal_matrix, Matrix6::Zero());
  EXPECT_EQ(nothing.descent, Vector6::Zero());
}

TEST(PoseCostExpansion, IgnoresPointsBehindTheCamera) {
  std::vector<WeightedPoint> points = some_points(6, kPose);
  const PoseExpansion without = side_by_side(points).expand(stereo_rig(), kPose, kWidth);
  for (const double depth : {-1.0, 0.0}) {
    points.push_back(points.front());
    points.back().point_in_world = inverse(kPose) * Eigen::Vector3d(0.3, 0.2, depth);
  }
  const PoseExpansion with = side_by_side(points).expand(stereo_rig(), kPose, kWidth);
  EXPECT_TRUE(with.normal_matrix.isApprox(without.normal_matrix, 1e-12));
  EXPECT_TRUE(with.descent.isApprox(without.descent, 1e-12));
  EXPECT_NEAR(with.cost - without.cost, 2.0 * points.front().weight * huber_cost(1e4, kWidth), 1e-6);
}

TEST(PoseCostExpansion, SquaresWeights) {
  std::vector<WeightedPoint> points = some_points(9, kPose);
  WeightedPoints squared = side_by_side(points);
  squared.square_weights();
  for (WeightedPoint& point : points) point.weight *= point.weight;
  expect_alike(squared.expand(stereo_rig(), kPose, kWidth), expand_one_by_one(points, kPose));
}

TEST(PoseCostExpansion, IsBitIdenticalForEveryInstructionSet) {
  const WeightedPoints points = side_by_side(some_points(102, kPose));
  const PoseExpansion usual = points.expand(stereo_rig(), kPose, kWidth);
  for (const auto target : hwy::SupportedAndGeneratedTargets()) {
    hwy::SetSupportedTargetsForTest(target);
    const PoseExpansion expansion = points.expand(stereo_rig(), kPose, kWidth);
    EXPECT_EQ(expansion.cost, usual.cost) << hwy::TargetName(target);
    EXPECT_EQ(expansion.normal_matrix, usual.normal_matrix) << hwy::TargetName(target);
    EXPECT_EQ(expansion.descent, usual.descent) << hwy::TargetName(target);
  }
  hwy::SetSupportedTargetsForTest(0);
}

}  // namespace
}  // namespace byre
