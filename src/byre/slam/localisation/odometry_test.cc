#include "byre/slam/localisation/odometry.h"

#include "byre/geometry/geometry_matchers.h"

#include <limits>

#include <gmock/gmock.h>

namespace byre {
namespace {

Pose at(double x) {
  return {Eigen::Quaterniond::Identity(), {x, 0.0, 0.0}};
}

// Body pose, so many metres ahead of its pose by online points.
Odometry::Offset ahead_by(double x, double sigma = 0.0) {
  return {at(x), sigma};
}

Odometry started_at(const Pose& map_from_body) {
  Odometry odometry;
  odometry.correct(map_from_body);
  return odometry;
}

TEST(Odometry, StartsAtTheBodyPose) {
  Odometry odometry = started_at(at(5.0));
  EXPECT_THAT(odometry.odometry_from_body(), PoseNear(Pose{}, 1e-12, 1e-12));
  odometry.advance_to(at(6.0), {});
  EXPECT_THAT(odometry.odometry_from_body(), PoseNear(at(1.0), 1e-12, 1e-12));
  EXPECT_THAT(odometry.map_from_body(), PoseNear(at(6.0), 1e-12, 1e-12));
}

TEST(Odometry, DoesNotJumpWhenTheMapPoseIsCorrected) {
  Odometry odometry = started_at(at(0.0));
  const Pose before{rotation_exp({0.0, 0.0, 0.3}), {1.0, 2.0, 0.0}};
  const Pose after{rotation_exp({0.0, 0.0, 0.2}), {1.4, 1.9, 0.1}};
  odometry.advance_to(before, {});
  odometry.correct(after);
  EXPECT_THAT(odometry.odometry_from_body(), PoseNear(before, 1e-12, 1e-12));
  EXPECT_THAT(odometry.map_from_body(), PoseNear(after, 1e-12, 1e-12));
}

TEST(Odometry, FollowsTheBodyAfterACorrection) {
  Odometry odometry = started_at(at(0.0));
  const Pose before{rotation_exp({0.0, 0.0, 0.3}), {1.0, 2.0, 0.0}};
  const Pose after = at(3.0);
  odometry.advance_to(before, {});
  odometry.correct(after);
  const Pose motion{rotation_exp({0.1, 0.0, 0.0}), {0.2, 0.0, 0.0}};  // motion in the body's own frame
  odometry.advance_to(after * motion, {});
  EXPECT_THAT(odometry.odometry_from_body(), PoseNear(before * motion, 1e-12, 1e-12));
}

TEST(Odometry, ExcludesCorrectionsFromThePathLength) {
  Odometry odometry = started_at(at(0.0));
  odometry.advance_to(at(1.0), {});
  odometry.correct(at(4.0));
  EXPECT_NEAR(odometry.advance_to(at(4.5), {}).metres, 0.5, 1e-12);
  EXPECT_NEAR(odometry.travelled(), 1.5, 1e-12);
}

TEST(Odometry, FollowsMeasuredMotionIndependentOfTheMapPose) {
  Odometry odometry = started_at(at(0.0));
  odometry.advance_to(at(1.0), {});
  odometry.move_by_odometry(at(0.2), at(7.0));
  EXPECT_THAT(odometry.map_from_body(), PoseNear(at(7.0), 1e-12, 1e-12));
  EXPECT_THAT(odometry.odometry_from_body(), PoseNear(at(1.2), 1e-12, 1e-12));
  EXPECT_NEAR(odometry.travelled(), 1.2, 1e-12);
}

TEST(Odometry, ExcludesStepsCausedByOfflinePoints) {
  Odometry odometry = started_at(at(0.0));
  odometry.advance_to(at(1.0), ahead_by(0.0));
  const Odometry::Step step = odometry.advance_to(at(1.5), ahead_by(0.3));  // 0.2 m by online points
  EXPECT_THAT(step.smooth, PoseNear(at(1.2), 1e-12, 1e-12));
  EXPECT_NEAR(step.metres, 0.2, 1e-12);
  EXPECT_THAT(odometry.odometry_from_body(), PoseNear(at(1.2), 1e-12, 1e-12));
  EXPECT_THAT(odometry.map_from_body(), PoseNear(at(1.5), 1e-12, 1e-12));
  EXPECT_NEAR(odometry.advance_to(at(1.6), ahead_by(0.3)).metres, 0.1, 1e-12);
}

TEST(Odometry, IgnoresASmallChangeOfTheOffset) {
  Odometry odometry = started_at(at(0.0));
  odometry.advance_to(at(1.0), ahead_by(0.0));
  EXPECT_NEAR(odometry.advance_to(at(1.005), ahead_by(0.005)).metres, 0.005, 1e-12);
}

TEST(Odometry, IgnoresTheOffsetOfUncertainOnlinePoints) {
  Odometry odometry = started_at(at(0.0));
  odometry.advance_to(at(1.0), ahead_by(0.0, 0.08));
  const Odometry::Step step = odometry.advance_to(at(1.1), ahead_by(-0.3, 0.08));  // few points, in the dark
  EXPECT_NEAR(step.metres, 0.1, 1e-12);
  EXPECT_THAT(step.smooth, PoseNear(at(1.1), 1e-12, 1e-12));
}

TEST(Odometry, DoesNotCompareOffsetsAcrossAGap) {
  Odometry odometry = started_at(at(0.0));
  odometry.advance_to(at(1.0), ahead_by(0.0));
  odometry.set_offset({});
  EXPECT_NEAR(odometry.advance_to(at(1.5), ahead_by(0.3)).metres, 0.5, 1e-12);
}

TEST(Odometry, StaysFinite) {
  Odometry odometry = started_at(at(0.0));
  odometry.advance_to(at(1.0), {});
  const Pose none = at(std::numeric_limits<double>::quiet_NaN());
  odometry.correct(none);
  odometry.advance_to(none, {});
  odometry.move_by_odometry(none, none);
  odometry.move_by_odometry(at(std::numeric_limits<double>::infinity()), at(1.0));
  EXPECT_THAT(odometry.odometry_from_body(), PoseNear(at(1.0), 1e-12, 1e-12));
  odometry.advance_to(at(2.0), {});
  EXPECT_THAT(odometry.odometry_from_body(), PoseNear(at(2.0), 1e-12, 1e-12));
  EXPECT_DOUBLE_EQ(odometry.travelled(), 2.0);
}

}  // namespace
}  // namespace byre
