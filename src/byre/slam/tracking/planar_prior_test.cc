#include "byre/slam/tracking/planar_prior.h"

#include "byre/geometry/geometry_matchers.h"
#include "byre/map/plan/driven_scene.h"
#include "byre/slam/tracking/body_pose.h"

#include <gmock/gmock.h>

namespace byre {
namespace {

Pose camera_of(const Pose& level_from_body) {
  return camera_pose(looking_down(), kMapFromLevel * level_from_body);
}

// Deviation of a prior from a pose, in the body, with its sigmas.
struct Said {
  Vector6 delta;
  Vector6 sigmas;
};
Said said_of(const PosePrior& prior, const Pose& level_from_body) {
  const Pose body = kMapFromLevel * level_from_body;
  const Matrix6 covariance = move_covariance(prior.covariance, looking_down().body_from_camera);
  return {log_pose(inverse(body) * body_pose(looking_down(), prior.camera_from_world)),
          covariance.diagonal().cwiseSqrt()};
}

TEST(PlanarPrior, ConstrainsHeightAndTiltOnly) {
  const auto ground = DrivenGround::under(map_of(driven()));
  ASSERT_TRUE(ground);
  Pose body = on_floor(14.0, 1.2, 0.4);
  body.translation.z() += 0.015;
  body.rotation = body.rotation * rotation_exp({0.006, -0.004, 0.0});
  const auto prior = planar_prior(*ground, looking_down(), camera_of(body));
  ASSERT_TRUE(prior);
  const Pose placed = inverse(kMapFromLevel) * body_pose(looking_down(), prior->camera_from_world);
  EXPECT_THAT(placed, PoseNear(on_floor(14.0, 1.2, 0.4), 0.002, 0.05 * kDegree));
  const Said said = said_of(*prior, body);
  EXPECT_GT(said.sigmas[0], 5.0);
  EXPECT_GT(said.sigmas[1], 5.0);
  EXPECT_LT(said.sigmas[2], 0.04);
  EXPECT_LT(said.sigmas[3], 0.01);
  EXPECT_LT(said.sigmas[4], 0.01);
  EXPECT_GT(said.sigmas[5], 1.0);
}

TEST(PlanarPrior, IsEmptyForABodyInAnotherAttitude) {
  const auto ground = DrivenGround::under(map_of(driven()));
  ASSERT_TRUE(ground);
  Pose lifted = on_floor(14.0, 1.0, 0.0);
  lifted.translation.z() += 0.3;
  EXPECT_FALSE(planar_prior(*ground, looking_down(), camera_of(lifted)));
  const Pose tilted = on_floor(14.0, 1.0, 0.0) * Pose{rotation_exp({0.0, 0.1, 0.0}), Eigen::Vector3d::Zero()};
  EXPECT_FALSE(planar_prior(*ground, looking_down(), camera_of(tilted))) << "a new ramp";
  EXPECT_FALSE(planar_prior(*ground, looking_down(), camera_of(on_floor(14.0, 9.0, 0.0)))) << "far from the path";
}

TEST(PlanarPrior, FusesWithAPose) {
  Matrix6 of_one = Matrix6::Identity(), of_other = Matrix6::Identity();
  of_one.diagonal() << 1e-4, 1e-4, 1.0, 1e-4, 1e-4, 1e-4;
  of_other.diagonal() << 100.0, 100.0, 1e-4, 9.0, 9.0, 9.0;
  const Pose here, there{Eigen::Quaterniond::Identity(), {0.5, 0.0, 0.2}};
  const PosePrior both = combined({here, of_one}, {there, of_other});
  EXPECT_THAT(both.camera_from_world, PoseNear(Pose{Eigen::Quaterniond::Identity(), {0.0, 0.0, 0.2}}, 1e-3, 1e-3));
  EXPECT_NEAR(both.covariance(0, 0), 1e-4, 1e-6);
  EXPECT_NEAR(both.covariance(2, 2), 1e-4, 1e-6);
}

}  // namespace
}  // namespace byre
