#include "byre/playback/play.h"

#include "byre/geometry/geometry_matchers.h"

#include <gmock/gmock.h>

namespace byre {
namespace {

const Pose kMapFromBody{rotation_exp({0.1, 0.2, 0.3}), {1.0, 2.0, 3.0}};

PlanRegistration turned_and_shifted() {
  PlanRegistration registration;
  registration.plan_from_map.target_from_source = {rotation_exp({0.0, 0.0, 1.0}), {500000.0, 5400000.0, 0.0}};
  return registration;
}

TEST(RunOnPlan, TransformsOnlyPosesInTheMap) {
  const PlanRegistration registration = turned_and_shifted();
  RunResult run;
  run.causal = run.final = run.odometry = {{{}, kMapFromBody}};
  run.frames.resize(3);
  run.frames[1].report.emplace();
  run.frames[2].report.emplace();
  run.frames[2].report->map_from_body = kMapFromBody;
  run.frames[2].report->odometry_from_body = kMapFromBody;
  const RunResult moved = on_plan(run, registration);
  const Pose expected = registration.plan_from_map.target_from_source * kMapFromBody;
  EXPECT_THAT(moved.causal[0].world_from_body, PoseNear(expected, 1e-9, 1e-9));
  EXPECT_THAT(moved.final[0].world_from_body, PoseNear(expected, 1e-9, 1e-9));
  EXPECT_THAT(moved.odometry[0].world_from_body, PoseNear(kMapFromBody, 0.0, 1e-9));
  EXPECT_FALSE(moved.frames[0].report.has_value());
  EXPECT_FALSE(moved.frames[1].report->map_from_body.has_value());
  EXPECT_THAT(*moved.frames[2].report->map_from_body, PoseNear(expected, 1e-9, 1e-9));
  EXPECT_THAT(*moved.frames[2].report->odometry_from_body, PoseNear(kMapFromBody, 0.0, 1e-9));
}

TEST(RunOnPlan, AddsTheCovarianceOfTheRegistration) {
  PlanRegistration registration = turned_and_shifted();
  registration.covariance(5, 5) = 1e-4;  // about the vertical through the origin of the map
  PlayedFrame frame;
  frame.report.emplace();
  frame.report->map_from_body = Pose{Eigen::Quaterniond::Identity(), {10.0, 0.0, 0.0}};
  frame.report->covariance = 1e-6 * Matrix6::Identity();
  const Matrix6 on_floor = on_plan(frame, registration).report->covariance;
  EXPECT_NEAR(on_floor(0, 0), 1e-6, 1e-12);
  EXPECT_NEAR(on_floor(1, 1), 1e-6 + 100.0 * 1e-4, 1e-9);
}

}  // namespace
}  // namespace byre
