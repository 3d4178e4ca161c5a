#include "byre/trajectory.h"

#include "byre/geometry/geometry_matchers.h"

#include <gtest/gtest.h>

namespace byre {
namespace {

using std::chrono::milliseconds;
using testing::Eq;
using testing::Optional;

Pose at_x(double x, double yaw = 0.0) {
  return {rotation_exp({0.0, 0.0, yaw}), {x, 0.0, 0.0}};
}

// Samples at 1.0 s, 1.1 s and, after a gap, 2.1 s.
Trajectory with_a_gap() {
  return {{milliseconds(1000), at_x(0.0)}, {milliseconds(1100), at_x(1.0, 0.4)}, {milliseconds(2100), at_x(2.0, 0.4)}};
}

TEST(FromSeconds, RoundsToTheNearestNanosecond) {
  EXPECT_EQ(from_seconds(0.1), Timestamp(100'000'000));
  EXPECT_EQ(from_seconds(1.9999999996), Timestamp(2'000'000'000));
  EXPECT_EQ(from_seconds(-0.5), Timestamp(-500'000'000));
}

TEST(ToSeconds, InvertsFromSeconds) {
  EXPECT_DOUBLE_EQ(to_seconds(from_seconds(1234.5678)), 1234.5678);
}

TEST(PoseAt, ReturnsASampleAtItsOwnTime) {
  EXPECT_THAT(pose_at(with_a_gap(), milliseconds(1100), milliseconds(0)), Optional(PoseNear(at_x(1.0, 0.4), 0.0, 0.0)));
}

TEST(PoseAt, InterpolatesBetweenSamples) {
  EXPECT_THAT(pose_at(with_a_gap(), milliseconds(1025), milliseconds(100)),
              Optional(PoseNear(at_x(0.25, 0.1), 1e-12, 1e-12)));
}

TEST(PoseAt, IsEmptyInAGapLongerThanAllowed) {
  EXPECT_THAT(pose_at(with_a_gap(), milliseconds(1500), milliseconds(999)), Eq(std::nullopt));
  EXPECT_TRUE(pose_at(with_a_gap(), milliseconds(1500), milliseconds(1000)).has_value());
}

TEST(PoseAt, IsEmptyOutsideTheTrajectory) {
  EXPECT_FALSE(pose_at(with_a_gap(), milliseconds(999), milliseconds(5000)).has_value());
  EXPECT_FALSE(pose_at(with_a_gap(), milliseconds(2101), milliseconds(5000)).has_value());
  EXPECT_FALSE(pose_at({}, milliseconds(1000), milliseconds(5000)).has_value());
}

}  // namespace
}  // namespace byre
