#include "byre/plan_registration.h"

#include "byre/geometry/geometry_matchers.h"

#include <gmock/gmock.h>

namespace byre {
namespace {

PlanRegistration any_registration() {
  PlanRegistration registration;
  registration.plan_from_map.scale = 2.5;
  registration.plan_from_map.target_from_source = {rotation_exp({0.1, -0.2, 1.3}), {10.0, -4.0, 0.5}};
  return registration;
}

TEST(PlanRegistration, TransformsPosesLikePoints) {
  const PlanRegistration registration = any_registration();
  const Pose map_from_body{rotation_exp({0.4, 0.5, -0.6}), {1.0, 2.0, 3.0}};
  const Pose pose = plan_from_body(registration, map_from_body);
  EXPECT_THAT(pose.translation, PointNear(registration.plan_from_map * map_from_body.translation, 1e-12));
  const Eigen::Vector3d tip_in_map = map_from_body * Eigen::Vector3d(0.2, 0.0, 0.0);
  EXPECT_THAT(pose * Eigen::Vector3d(0.5, 0.0, 0.0), PointNear(registration.plan_from_map * tip_in_map, 1e-12));
}

TEST(PlanRegistration, HasTheJacobianOfSmallMotions) {
  const PlanRegistration registration = any_registration();
  const Eigen::Vector3d point_in_map(3.0, -1.0, 2.0);
  const PlanJacobian jacobian = plan_jacobian(registration.plan_from_map, point_in_map);
  constexpr double kStep = 1e-6;
  for (int i = 0; i < 7; ++i) {
    Eigen::Matrix<double, 7, 1> delta = Eigen::Matrix<double, 7, 1>::Zero();
    delta[i] = kStep;
    Similarity moved = registration.plan_from_map;
    moved.target_from_source = moved.target_from_source * exp_pose(delta.head<6>());
    moved.scale *= std::exp(delta[6]);
    const Eigen::Vector3d slope = (moved * point_in_map - registration.plan_from_map * point_in_map) / kStep;
    EXPECT_THAT(Eigen::Vector3d(jacobian.col(i)), PointNear(slope, 1e-4)) << "of unknown " << i;
  }
}

// Checked by finite differences of all inputs of a pose on the plan.
TEST(PlanRegistration, AddsItsCovarianceToThatOfAPose) {
  PlanRegistration registration = any_registration();
  const Eigen::Matrix<double, 7, 1> sigmas{0.02, 0.03, 0.01, 0.002, 0.001, 0.004, 0.005};
  registration.covariance =
      sigmas.asDiagonal() * (0.2 * Matrix7::Ones() + 0.8 * Matrix7::Identity()) * sigmas.asDiagonal();
  const Pose map_from_body{rotation_exp({0.4, 0.5, -0.6}), {1.0, 2.0, 3.0}};
  const Matrix6 in_map = 1e-4 * (Matrix6::Identity() + Matrix6::Ones());
  const Pose on_plan = plan_from_body(registration, map_from_body);
  constexpr double kStep = 1e-6;
  Eigen::Matrix<double, 6, 13> slopes;
  for (int i = 0; i < 13; ++i) {
    Eigen::Matrix<double, 13, 1> delta = Eigen::Matrix<double, 13, 1>::Zero();
    delta[i] = kStep;
    PlanRegistration moved = registration;
    moved.plan_from_map.target_from_source = moved.plan_from_map.target_from_source * exp_pose(delta.head<6>());
    moved.plan_from_map.scale *= std::exp(delta[6]);
    const Pose there = plan_from_body(moved, map_from_body * exp_pose(delta.tail<6>()));
    slopes.col(i) = log_pose(inverse(on_plan) * there) / kStep;
  }
  const Matrix6 expected = slopes.leftCols<7>() * registration.covariance * slopes.leftCols<7>().transpose() +
                           slopes.rightCols<6>() * in_map * slopes.rightCols<6>().transpose();
  EXPECT_LT((covariance_on_plan(registration, map_from_body, in_map) - expected).norm(), 1e-4 * expected.norm());
}

TEST(PlanRegistration, IsLessCertainFarFromItsYawCentre) {
  PlanRegistration registration;
  registration.covariance(0, 0) = registration.covariance(1, 1) = 1e-4;
  registration.covariance(5, 5) = 1e-6;
  const Eigen::Matrix2d covariance = plan_covariance_at(registration, {10.0, 0.0, 0.0});
  EXPECT_NEAR(covariance(0, 0), 1e-4, 1e-12);
  EXPECT_NEAR(covariance(1, 1), 1e-4 + 100.0 * 1e-6, 1e-12);
}

}  // namespace
}  // namespace byre
