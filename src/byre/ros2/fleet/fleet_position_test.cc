#include "byre/ros2/fleet/fleet_link.h"

#include <chrono>
#include <cmath>
#include <numbers>

#include <gmock/gmock.h>

namespace byre {
namespace {

using std::chrono_literals::operator""ms;
using std::chrono_literals::operator""s;
using ::testing::DoubleNear;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Optional;

Pose turned(double x, double y, double yaw) {
  return {Eigen::Quaterniond(Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitZ())), {x, y, 0.3}};
}

FrameReport report(Verdict verdict, const Pose& pose, Timestamp time = 1s) {
  FrameReport report;
  report.time = time;
  report.state = State::tracking;
  report.map_from_body = pose;
  report.odometry_from_body = pose;
  report.health.verdict = verdict;
  report.health.doubt = verdict == Verdict::trusted ? DistrustReason::none : DistrustReason::few_points;
  report.health.position_sigma = 0.01;
  report.health.distance_since_offline = 2.0;
  return report;
}

class FleetPositionTest : public testing::Test {
 protected:
  void note(const FrameReport& frame) { keeper_.note(frame, frame.time, "advice"); }

  FleetPositionKeeper keeper_;
};

TEST_F(FleetPositionTest, ProjectsThePoseToThePlane) {
  note(report(Verdict::trusted, turned(3.0, -2.0, 2.5)));
  const FleetPosition position = keeper_.at(1s);
  EXPECT_EQ(position.x, 3.0);
  EXPECT_EQ(position.y, -2.0);
  EXPECT_NEAR(position.theta, 2.5, 1e-12);
  EXPECT_TRUE(position.is_initialised);
  EXPECT_THAT(position.problem, IsEmpty());
  note(report(Verdict::trusted, turned(0.0, 0.0, std::numbers::pi + 0.1)));
  EXPECT_NEAR(keeper_.at(1s).theta, 0.1 - std::numbers::pi, 1e-12);
}

TEST_F(FleetPositionTest, ReportsTheErrorBoundAsDeviation) {
  note(report(Verdict::trusted, Pose{}));
  EXPECT_THAT(keeper_.at(1s).deviation, Optional(DoubleNear(std::hypot(3 * 0.01, 0.005 * 2.0), 1e-12)));
}

TEST_F(FleetPositionTest, ScoresByVerdictAndErrorBound) {
  FrameReport frame = report(Verdict::trusted, Pose{});
  EXPECT_NEAR(localization_score(frame), 1.0 - 0.5 * std::hypot(0.03, 0.01) / 0.2, 1e-12);
  frame.health.position_sigma = 1.0;
  EXPECT_EQ(localization_score(frame), 0.5);
  EXPECT_EQ(localization_score(report(Verdict::degraded, Pose{})), 0.4);
  EXPECT_EQ(localization_score(report(Verdict::untrusted, Pose{})), 0.1);
  frame.map_from_body.reset();
  EXPECT_EQ(localization_score(frame), 0.0);
}

TEST_F(FleetPositionTest, IsInitialisedFromATrustedFrameUntilLost) {
  EXPECT_FALSE(keeper_.at(1s).is_initialised);
  note(report(Verdict::degraded, Pose{}));
  EXPECT_FALSE(keeper_.at(1s).is_initialised);
  note(report(Verdict::trusted, Pose{}));
  note(report(Verdict::degraded, Pose{}));
  EXPECT_TRUE(keeper_.at(1s).is_initialised);
  EXPECT_THAT(keeper_.at(1s).problem, HasSubstr("degraded"));
  FrameReport lost = report(Verdict::untrusted, Pose{});
  note(lost);
  EXPECT_TRUE(keeper_.at(1s).is_initialised);
  lost.state = State::lost;
  note(lost);
  EXPECT_FALSE(keeper_.at(1s).is_initialised);
  note(report(Verdict::trusted, Pose{}));
  EXPECT_TRUE(keeper_.at(1s).is_initialised);
  keeper_.restart();
  EXPECT_FALSE(keeper_.at(1s).is_initialised);
}

TEST_F(FleetPositionTest, KeepsTheLastReliablePosition) {
  note(report(Verdict::trusted, turned(3.0, 0.0, 0.0)));
  note(report(Verdict::untrusted, turned(40.0, 0.0, 0.0)));
  EXPECT_EQ(keeper_.at(1s).x, 3.0);
  EXPECT_FALSE(keeper_.at(1s).deviation);
}

TEST_F(FleetPositionTest, ReportsVelocityInTheRobotFrame) {
  note(report(Verdict::trusted, turned(0.0, 0.0, std::numbers::pi / 2), 1s));
  EXPECT_FALSE(keeper_.at(1s).velocity);
  note(report(Verdict::trusted, turned(0.0, 0.1, std::numbers::pi / 2 + 0.02), 1s + 100ms));
  const auto velocity = keeper_.at(1s).velocity;
  ASSERT_TRUE(velocity);
  EXPECT_NEAR(velocity->vx, 1.0, 1e-9);
  EXPECT_NEAR(velocity->vy, 0.0, 1e-9);
  EXPECT_NEAR(velocity->omega, 0.2, 1e-9);
}

TEST_F(FleetPositionTest, IsUnknownWithoutFrames) {
  EXPECT_THAT(keeper_.at(1s).problem, HasSubstr("no image"));
  note(report(Verdict::trusted, turned(3.0, 0.0, 0.0)));
  EXPECT_TRUE(keeper_.at(4s).is_initialised);
  const FleetPosition position = keeper_.at(4s + 1ms);
  EXPECT_FALSE(position.is_initialised);
  EXPECT_EQ(position.score, 0.0);
  EXPECT_EQ(position.x, 3.0);
  EXPECT_THAT(position.problem, HasSubstr("no images arrive"));
}

}  // namespace
}  // namespace byre
