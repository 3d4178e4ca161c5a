#include "byre/odometry/wheel_track.h"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

namespace byre {
namespace {

using std::numbers::pi;

// A base with a given velocity over time, between two times in seconds.
template <typename Velocity>
void add(WheelTrack& track, double from, double until, double step, const Velocity& velocity) {
  for (double t = from; t <= until + 1e-9; t += step) {
    const Eigen::Vector3d now = velocity(t);
    track.add(BaseTwist{from_seconds(t), now.x(), now.y(), now.z()});
  }
}

Pose way(const WheelTrack& track, double from, double until) {
  return track.between(from_seconds(from), from_seconds(until)).value();
}

void expect_at(const Pose& pose, double x, double y, double yaw, double tolerance) {
  EXPECT_NEAR(pose.translation.x(), x, tolerance);
  EXPECT_NEAR(pose.translation.y(), y, tolerance);
  EXPECT_EQ(pose.translation.z(), 0.0);
  EXPECT_NEAR(rotation_log(pose.rotation).z(), yaw, tolerance);
}

TEST(WheelTrack, FollowsArcsOfVelocities) {
  WheelTrack track;  // a quarter of a circle in two seconds, sampled at 5 Hz
  add(track, 0.0, 2.0, 0.2, [](double) { return Eigen::Vector3d(0.25 * pi * 2.0, 0.0, 0.25 * pi); });
  expect_at(way(track, 0.0, 2.0), 2.0, 2.0, 0.5 * pi, 1e-9);
  expect_at(way(track, 0.0, 1.0), 2.0 * std::sin(0.25 * pi), 2.0 - 2.0 * std::cos(0.25 * pi), 0.25 * pi, 1e-9);
}

TEST(WheelTrack, AveragesChangingVelocities) {
  WheelTrack track;  // half a metre per second squared
  add(track, 0.0, 2.0, 0.1, [](double t) { return Eigen::Vector3d(0.5 * t, 0.0, 0.0); });
  expect_at(way(track, 0.0, 2.0), 1.0, 0.0, 0.0, 1e-9);
}

TEST(WheelTrack, MovesSidewaysForAnOmnidirectionalBase) {
  WheelTrack track;
  add(track, 0.0, 2.0, 0.05, [](double) { return Eigen::Vector3d(0.0, -0.3, 0.0); });
  expect_at(way(track, 0.0, 2.0), 0.0, -0.6, 0.0, 1e-9);
  WheelTrack circling;  // faces one point while it circles around it
  add(circling, 0.0, 3.0, 0.1, [](double) { return Eigen::Vector3d(0.0, -pi / 6.0, pi / 6.0); });
  expect_at(way(circling, 0.0, 3.0), 1.0, -1.0, 0.5 * pi, 1e-6);
  EXPECT_NEAR(circling.distance(from_seconds(0.0), from_seconds(3.0))->metres, 0.5 * pi, 0.01);
}

TEST(WheelTrack, IsEmptyAcrossAGapBetweenVelocities) {
  WheelTrack track;
  const auto fast = [](double) { return Eigen::Vector3d(1.0, 0.0, 0.0); };
  add(track, 0.0, 1.0, 0.05, fast);
  add(track, 1.4, 2.4, 0.05, fast);
  expect_at(way(track, 0.2, 1.0), 0.8, 0.0, 0.0, 1e-9);
  expect_at(way(track, 1.4, 2.4), 1.0, 0.0, 0.0, 1e-9);
  EXPECT_FALSE(track.between(from_seconds(0.9), from_seconds(1.5)));
  EXPECT_FALSE(track.between(from_seconds(1.1), from_seconds(1.3)));
  EXPECT_FALSE(track.distance(from_seconds(0.9), from_seconds(1.5)));
}

TEST(WheelTrack, IntegratesAcrossAMissingSample) {
  WheelTrack track;
  const auto fast = [](double) { return Eigen::Vector3d(1.0, 0.0, 0.1); };
  add(track, 0.0, 1.0, 0.1, fast);
  add(track, 1.2, 2.0, 0.1, fast);
  EXPECT_NEAR(way(track, 0.0, 2.0).translation.x(), 10.0 * std::sin(0.2), 1e-9);
}

TEST(WheelTrack, ExtrapolatesTheLastVelocityForAQuarterOfASecond) {
  WheelTrack track;
  add(track, 0.0, 1.0, 0.1, [](double t) { return Eigen::Vector3d(t < 0.95 ? 0.0 : 1.0, 0.0, 0.0); });
  expect_at(way(track, 1.0, 1.2), 0.2, 0.0, 0.0, 1e-9);
  EXPECT_FALSE(track.between(from_seconds(1.0), from_seconds(1.3)));
}

TEST(WheelTrack, IsEmptyFromVelocitiesToPoses) {
  WheelTrack track;
  add(track, 0.0, 1.0, 0.1, [](double) { return Eigen::Vector3d(1.0, 0.0, 0.0); });
  for (int i = 11; i < 20; ++i) {
    track.add(StampedPose{from_seconds(0.1 * i), {Eigen::Quaterniond::Identity(), {0.1 * i, 5.0, 0.0}}});
  }
  EXPECT_FALSE(track.between(from_seconds(0.9), from_seconds(1.2)));
  expect_at(way(track, 1.2, 1.7), 0.5, 0.0, 0.0, 1e-9);
}

TEST(WheelTrack, ContinuesTheFirstMotionBackwards) {
  WheelTrack track;
  track.add(StampedPose{from_seconds(1.0), Pose{}});
  EXPECT_FALSE(track.pose_at(from_seconds(0.96))) << "one pose has no motion";
  track.add(StampedPose{from_seconds(1.1), Pose{Eigen::Quaterniond::Identity(), {0.2, 0.0, 0.0}}});
  ASSERT_TRUE(track.pose_at(from_seconds(0.96)));
  EXPECT_NEAR(track.pose_at(from_seconds(0.96))->translation.x(), -0.08, 1e-9);
  EXPECT_FALSE(track.pose_at(from_seconds(0.94)));
}

}  // namespace
}  // namespace byre
