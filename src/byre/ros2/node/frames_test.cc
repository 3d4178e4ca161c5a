// Robot frames: map -> odom -> base.

#include "byre/io/ros/message_matchers.h"
#include "byre/playback/report/ros_report.h"
#include "byre/ros2/node/robot_frames.h"

#include <gmock/gmock.h>

namespace byre {
namespace {

Pose some_pose(double seed) {
  const Eigen::Vector3d turn(0.3 * seed, -0.2, 0.1 + seed);
  return {rotation_exp(turn), {seed, 2.0 - seed, 0.5 * seed}};
}

double distance(const Pose& a, const Pose& b) {
  return (a.translation - b.translation).norm() + angle_between(a.rotation, b.rotation);
}

FrameReport report_at(const std::optional<Pose>& odometry, const std::optional<Pose>& in_map,
                      Verdict verdict = Verdict::trusted) {
  FrameReport report;
  report.state = State::tracking;
  report.map_from_body = in_map;
  report.odometry_from_body = odometry;
  report.health.verdict = verdict;
  return report;
}

TEST(PoseFrames, ComposeMapAndOdometry) {
  PoseFrames frames;
  frames.note(report_at(some_pose(1), some_pose(2)));
  EXPECT_LT(distance(*frames.map_from_odom() * *frames.odom_from_base(), some_pose(2)), 1e-9);
  EXPECT_FALSE(frames.is_held());
}

TEST(PoseFrames, HoldTheMapFrameInDoubtAndWithdrawItWhenLost) {
  PoseFrames frames;
  frames.note(report_at(some_pose(1), some_pose(2), Verdict::untrusted));
  EXPECT_FALSE(frames.map_from_odom()) << "no trusted frame so far";
  frames.note(report_at(some_pose(1), some_pose(2)));
  const Pose known = *frames.map_from_odom();
  frames.note(report_at(some_pose(3), some_pose(0.5), Verdict::untrusted));
  ASSERT_TRUE(frames.map_from_odom());
  EXPECT_LT(distance(*frames.map_from_odom(), known), 1e-12);
  EXPECT_TRUE(frames.is_held());
  FrameReport lost = report_at(std::nullopt, std::nullopt, Verdict::untrusted);
  lost.events = {SessionEvent::navigation_error};
  frames.note(lost);
  EXPECT_FALSE(frames.map_from_odom());
  EXPECT_FALSE(frames.odom_from_base());
}

TEST(PoseFrames, ContinueOdometryAfterReinitialisation) {
  PoseFrames frames;
  frames.note(report_at(some_pose(1), some_pose(2)));
  const Pose before = *frames.odom_from_base();
  frames.restart();
  EXPECT_FALSE(frames.map_from_odom());
  frames.note(report_at(some_pose(7), std::nullopt));
  EXPECT_LT(distance(*frames.odom_from_base(), before), 1e-9);
  frames.note(report_at(some_pose(7) * some_pose(0.2), std::nullopt));
  EXPECT_LT(distance(*frames.odom_from_base(), before * some_pose(0.2)), 1e-9);
}

TEST(PoseFrames, AttachTheMapToTheOdometryOfItsOwner) {
  PoseFrames frames;
  frames.note(report_at(some_pose(1), some_pose(2)));
  EXPECT_TRUE(frames.is_odometry_own());
  frames.note(report_at(some_pose(1), some_pose(2)), std::nullopt);
  EXPECT_FALSE(frames.is_odometry_own());
  EXPECT_FALSE(frames.map_from_odom()) << "that of the own odometry does not hold for another odom frame";
  frames.note(report_at(some_pose(1), some_pose(2)), some_pose(4));
  ASSERT_TRUE(frames.map_from_odom());
  EXPECT_LT(distance(*frames.map_from_odom() * some_pose(4), some_pose(2)), 1e-9);
  frames.note(report_at(some_pose(1), some_pose(3)), std::nullopt);
  EXPECT_TRUE(frames.is_held());
}

TEST(PoseMessages, RotateCovariancesIntoTheParentFrame) {
  Matrix6 covariance = Matrix6::Zero();
  covariance(0, 0) = 4.0;   // along x of the body
  covariance(5, 5) = 0.01;  // about z of the body
  covariance(0, 5) = covariance(5, 0) = 0.1;
  const Eigen::Quaterniond quarter(Eigen::AngleAxisd(M_PI / 2, Eigen::Vector3d::UnitZ()));  // turns x to y
  const std::array<double, 36> turned = ros_covariance(covariance, quarter);
  EXPECT_NEAR(turned[0], 0.0, 1e-12);
  EXPECT_NEAR(turned[7], 4.0, 1e-12);
  EXPECT_NEAR(turned[35], 0.01, 1e-12);
  EXPECT_NEAR(turned[11], 0.1, 1e-12) << "row y, column of the rotation about z";
}

TEST(PoseMessages, ExpressMotionInTheBodyFrame) {
  const Eigen::Quaterniond quarter(Eigen::AngleAxisd(M_PI / 2, Eigen::Vector3d::UnitZ()));
  const ros::Twist twist = twist_between({quarter, {1, 0, 0}}, {quarter, {1, 0.1, 0}}, from_seconds(0.05));
  EXPECT_NEAR(twist.linear.x, 2.0, 1e-9) << "forward, which is y of the parent";
  EXPECT_NEAR(twist.linear.y, 0.0, 1e-9);
  const ros::Twist turning =
      twist_between({}, {rotation_exp({0, 0, 0.02}), Eigen::Vector3d::Zero()}, from_seconds(0.1));
  EXPECT_NEAR(turning.angular.z, 0.2, 1e-9);
}

}  // namespace
}  // namespace byre
