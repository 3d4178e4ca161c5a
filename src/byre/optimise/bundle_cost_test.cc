#include "byre/optimise/bundle_cost.h"

#include "byre/geometry/geometry_matchers.h"
#include "byre/optimise/optimise_scene.h"
#include "byre/optimise/rotation_manifold.h"

#include <tuple>
#include <vector>

#include <gtest/gtest.h>

namespace byre {
namespace {

using Vector9 = Eigen::Matrix<double, 9, 1>;
using Jacobian9 = Eigen::Matrix<double, 3, 9>;  // columns: rotation, translation, point

struct Parameters {
  Eigen::Quaterniond rotation;
  Eigen::Vector3d translation;
  Eigen::Vector3d point;
};

Parameters moved(const Parameters& parameters, const Vector9& delta) {
  Parameters result = parameters;
  RotationManifold().Plus(parameters.rotation.coeffs().data(), delta.data(), result.rotation.coeffs().data());
  result.translation += delta.segment<3>(3);
  result.point += delta.tail<3>();
  return result;
}

// Which of the parameters a cost function takes, in order.
enum class Takes { pose_and_point, pose, point };

std::vector<const double*> blocks_of(const Parameters& parameters, Takes takes) {
  const double* const rotation = parameters.rotation.coeffs().data();
  if (takes == Takes::point) return {parameters.point.data()};
  if (takes == Takes::pose) return {rotation, parameters.translation.data()};
  return {rotation, parameters.translation.data(), parameters.point.data()};
}

Eigen::Vector3d residual_at(const ceres::CostFunction& cost, const Parameters& parameters, Takes takes) {
  Eigen::Vector3d residual = Eigen::Vector3d::Zero();  // a cost may have fewer rows
  EXPECT_TRUE(cost.Evaluate(blocks_of(parameters, takes).data(), residual.data(), nullptr));
  return residual;
}

// Central differences; columns of parameters not taken are zero.
Jacobian9 numeric_jacobian(const ceres::CostFunction& cost, const Parameters& at, Takes takes) {
  constexpr double kStep = 1e-6;
  Jacobian9 jacobian;
  for (int i = 0; i < 9; ++i) {
    const Vector9 step = kStep * Vector9::Unit(i);
    const Eigen::Vector3d change =
        residual_at(cost, moved(at, step), takes) - residual_at(cost, moved(at, -step), takes);
    jacobian.col(i) = change / (2.0 * kStep);
  }
  return jacobian;
}

Jacobian9 analytic_jacobian(const ceres::CostFunction& cost, const Parameters& at, Takes takes) {
  Eigen::Matrix<double, 3, 4, Eigen::RowMajor> by_rotation = decltype(by_rotation)::Zero();
  Eigen::Matrix<double, 3, 3, Eigen::RowMajor> by_translation = decltype(by_translation)::Zero();
  Eigen::Matrix<double, 3, 3, Eigen::RowMajor> by_point = decltype(by_point)::Zero();
  std::vector<double*> jacobians{by_rotation.data(), by_translation.data(), by_point.data()};
  if (takes == Takes::point) jacobians = {by_point.data()};
  Eigen::Vector3d residual = Eigen::Vector3d::Zero();  // a cost may have fewer rows
  EXPECT_TRUE(cost.Evaluate(blocks_of(at, takes).data(), residual.data(), jacobians.data()));
  EXPECT_THAT(by_rotation.col(3), PointNear(Eigen::Vector3d::Zero(), 0.0));
  Jacobian9 jacobian;
  jacobian << by_rotation.leftCols<3>(), by_translation, by_point;
  return jacobian;
}

void expect_near(const Jacobian9& analytic, const Jacobian9& numeric) {
  EXPECT_LT((analytic - numeric).norm(), 1e-7 * (1.0 + numeric.norm())) << "analytic:\n"
                                                                        << analytic << "\nnumeric:\n"
                                                                        << numeric;
}

// At a depth and with a disparity sigma, negative for a monocular sighting.
class ReprojectionCostTest : public testing::TestWithParam<std::tuple<double, double>> {
 protected:
  ReprojectionCostTest() {
    const auto [depth, disparity_sigma] = GetParam();
    Draw draw(7);
    pose_ = exp_pose(draw.motion(1.0, 0.5));
    point_in_world_ = inverse(pose_) * Eigen::Vector3d(0.4, -0.7, depth);
    reprojection_ = Reprojection(stereo_rig(), {400.0, 100.0, 20.0}, 0.7, disparity_sigma);
  }

  Parameters parameters() const { return {pose_.rotation, pose_.translation, point_in_world_}; }

  Pose pose_;
  Eigen::Vector3d point_in_world_;
  Reprojection reprojection_{stereo_rig(), StereoPixel::Zero(), 1.0, 1.0};
};

TEST_P(ReprojectionCostTest, HasTheNumericJacobianByPoseAndPoint) {
  const PoseAndPointCost cost(reprojection_);
  expect_near(analytic_jacobian(cost, parameters(), Takes::pose_and_point),
              numeric_jacobian(cost, parameters(), Takes::pose_and_point));
}

TEST_P(ReprojectionCostTest, HasTheNumericJacobianByPoseAlone) {
  const PoseCost cost(reprojection_, point_in_world_);
  expect_near(analytic_jacobian(cost, parameters(), Takes::pose), numeric_jacobian(cost, parameters(), Takes::pose));
}

TEST_P(ReprojectionCostTest, HasTheNumericJacobianByPointAlone) {
  const PointCost cost(reprojection_, pose_);
  expect_near(analytic_jacobian(cost, parameters(), Takes::point), numeric_jacobian(cost, parameters(), Takes::point));
}

TEST(DistanceCost, HasTheNumericJacobian) {
  Draw draw(7);
  const Pose pose = exp_pose(draw.motion(1.0, 0.5));
  const Parameters parameters{pose.rotation, pose.translation, Eigen::Vector3d::Zero()};
  const DistanceCost cost({0.4, -0.7, 2.0}, 1.5, 0.1);
  expect_near(analytic_jacobian(cost, parameters, Takes::pose), numeric_jacobian(cost, parameters, Takes::pose));
}

TEST_P(ReprojectionCostTest, IsTheSameForAllThree) {
  const Eigen::Vector3d residual = residual_at(PoseAndPointCost(reprojection_), parameters(), Takes::pose_and_point);
  EXPECT_THAT(residual_at(PoseCost(reprojection_, point_in_world_), parameters(), Takes::pose),
              PointNear(residual, 1e-12 * residual.norm()));
  EXPECT_THAT(residual_at(PointCost(reprojection_, pose_), parameters(), Takes::point),
              PointNear(residual, 1e-12 * residual.norm()));
}

INSTANTIATE_TEST_SUITE_P(DepthAndDisparity, ReprojectionCostTest,
                         testing::Combine(testing::Values(5.0, 0.3, 0.005, -0.5), testing::Values(0.3, -1.0)));

TEST(Reprojection, IsTheErrorInSigmas) {
  const Rig rig = stereo_rig();
  const Eigen::Vector3d point_in_camera(0.5, -0.3, 2.0);
  const StereoPixel measured = rig.project(point_in_camera) - Eigen::Vector3d(1.0, -2.0, 0.5);
  const Reprojection reprojection(rig, measured, 0.5, 0.25);
  EXPECT_THAT(reprojection.residual(point_in_camera), PointNear(Eigen::Vector3d(2.0, -4.0, 2.0), 1e-10));
}

TEST(Reprojection, IgnoresTheDisparityOfAMonocularSighting) {
  const StereoPixel measured(300.0, 200.0, std::numeric_limits<double>::quiet_NaN());
  const Reprojection reprojection(stereo_rig(), measured, 1.0, -1.0);
  EXPECT_EQ(reprojection.residual({0.5, -0.3, 2.0}).z(), 0.0);
  EXPECT_EQ(reprojection.jacobian({0.5, -0.3, 2.0}).row(2).norm(), 0.0);
}

TEST(Reprojection, StaysFiniteAndGrowsAsThePointSlipsBehindTheCamera) {
  const Reprojection reprojection(stereo_rig(), {367.0, 252.0, 1.0}, 1.0, 0.3);
  double previous = 0.0;
  for (const double depth : {1.0, 0.1, 0.01, 1e-6, 0.0, -1e-6, -0.1, -10.0}) {
    const double error = reprojection.residual({0.1, 0.1, depth}).norm();
    EXPECT_TRUE(std::isfinite(error));
    EXPECT_GT(error, previous) << "at depth " << depth;
    previous = error;
  }
}

}  // namespace
}  // namespace byre
