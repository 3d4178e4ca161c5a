#include "byre/playback/report/ros_report.h"

#include "byre/io/ros/message_matchers.h"

#include <cmath>

#include <gmock/gmock.h>

namespace byre {
namespace {

using testing::Contains;
using testing::DoubleNear;
using testing::Field;
using testing::IsEmpty;
using testing::Not;
using testing::SizeIs;
using testing::StartsWith;

const Pose kMapFromBody{rotation_exp({0.0, 0.0, 0.5 * M_PI}), {1.0, 2.0, 0.5}};
const Pose kOdometryFromBody{rotation_exp({0.0, 0.0, 0.1}), {0.2, 0.0, 0.0}};

FrameReport report(Verdict verdict) {
  FrameReport report;
  report.time = Timestamp(1'500'000'000);
  report.map_from_body = kMapFromBody;
  report.odometry_from_body = kOdometryFromBody;
  report.health.verdict = verdict;
  report.health.doubt = verdict == Verdict::trusted ? DistrustReason::none : DistrustReason::few_points;
  return report;
}

Pose pose_of(const ros::Transform& transform) {
  const auto& [t, q] = transform;
  return {Eigen::Quaterniond(q.w, q.x, q.y, q.z), {t.x, t.y, t.z}};
}

TEST(RosReport, RotatesCovariancesIntoTheParentFrame) {
  Matrix6 in_body = Matrix6::Zero();
  in_body.diagonal() << 4.0, 1.0, 0.5, 0.4, 0.1, 0.2;  // a quarter turn about z swaps x and y
  const ros::PoseWithCovariance pose = pose_message({}, kMapFromBody, in_body).pose;
  const std::array<double, 6> expected = {1.0, 4.0, 0.5, 0.1, 0.4, 0.2};
  for (std::size_t i = 0; i < 6; ++i) EXPECT_THAT(pose.covariance[7 * i], DoubleNear(expected[i], 1e-12)) << i;
  EXPECT_EQ(pose.pose.position, (ros::Point{1.0, 2.0, 0.5}));
  EXPECT_THAT(pose.pose.orientation.z, DoubleNear(std::sqrt(0.5), 1e-12));
}

TEST(RosReport, ChainsMapOdometryAndBody) {
  const ros::TFMessage message = ros_transforms(report(Verdict::degraded));
  ASSERT_THAT(message.transforms, SizeIs(2));
  const auto& [map_to_odometry, odometry_to_body] = std::tie(message.transforms[0], message.transforms[1]);
  EXPECT_EQ(map_to_odometry.header.frame_id, "map");
  EXPECT_EQ(map_to_odometry.child_frame_id, "odom");
  EXPECT_EQ(odometry_to_body.header.frame_id, "odom");
  EXPECT_EQ(odometry_to_body.child_frame_id, "base_link");
  EXPECT_EQ(odometry_to_body.header.stamp, (ros::Time{1, 500'000'000}));
  const Pose chained = pose_of(map_to_odometry.transform) * pose_of(odometry_to_body.transform);
  EXPECT_LT((chained.translation - kMapFromBody.translation).norm(), 1e-12);
  EXPECT_LT(angle_between(chained.rotation, kMapFromBody.rotation), 1e-7);
}

TEST(RosReport, WithholdsThePoseInTheMapWhileItIsUntrusted) {
  EXPECT_TRUE(ros_map_pose(report(Verdict::trusted)).has_value());
  EXPECT_FALSE(ros_map_pose(report(Verdict::untrusted)).has_value());
  const ros::TFMessage message = ros_transforms(report(Verdict::untrusted));
  ASSERT_THAT(message.transforms, SizeIs(1));
  EXPECT_EQ(message.transforms[0].child_frame_id, "base_link");
  EXPECT_THAT(ros_transforms({}).transforms, IsEmpty());
}

TEST(RosReport, ContainsTheMotionSinceThePreviousFrame) {
  const Pose step = exp_pose((Vector6() << -0.5, 0, 0, 0, 0, -0.1).finished());
  const OdometrySample before{Timestamp(1'000'000'000), kOdometryFromBody * step, 1e-6 * Matrix6::Identity()};
  const OdometrySample now{report(Verdict::trusted).time, kOdometryFromBody, 1e-6 * Matrix6::Identity()};
  const ros::TwistWithCovariance twist = ros_odometry(report(Verdict::trusted), before, now).twist;
  EXPECT_THAT(twist.twist.linear.x, DoubleNear(1.0, 1e-9)) << "in the axes of the body at the later frame";
  EXPECT_THAT(twist.twist.angular.z, DoubleNear(0.2, 1e-9));
  EXPECT_GT(twist.covariance[0], 0.0);
  EXPECT_LT(twist.covariance[0], 1.0);
  const ros::TwistWithCovariance unknown = ros_odometry(report(Verdict::trusted), {}, now).twist;
  EXPECT_EQ(unknown.twist, ros::Twist{});
  EXPECT_EQ(unknown.covariance[0], kUnknownVariance);
}

TEST(RosReport, HasTheFiguresOfJsonReportsAsValues) {
  FrameReport shown = report(Verdict::trusted);
  shown.health.position_sigma = 0.012345678;
  EXPECT_THAT(health_values(shown), Contains(ros::KeyValue{"position_sigma_m", "0.0123457"}));
  EXPECT_THAT(health_values(shown), Not(Contains(Field(&ros::KeyValue::key, StartsWith("agreement")))));
  shown.health.agreement = Agreement{0.25, 0.125};
  EXPECT_THAT(health_values(shown), Contains(ros::KeyValue{"agreement.translation_m", "0.25"}));
}

TEST(RosReport, HasADiagnosticLevelByVerdict) {
  PlayedFrame frame;
  frame.report = report(Verdict::degraded);
  const ros::DiagnosticStatus degraded = ros_diagnostics(7, frame).status.at(0);
  EXPECT_EQ(degraded.level, ros::DiagnosticStatus::kWarn);
  EXPECT_EQ(degraded.message, "degraded: " + std::string(to_string(DistrustReason::few_points)));
  EXPECT_THAT(degraded.values, Contains(ros::KeyValue{"frame", "7"}));
  EXPECT_THAT(degraded.values, Contains(ros::KeyValue{"verdict", "degraded"}));
  frame.report = report(Verdict::trusted);
  EXPECT_EQ(ros_diagnostics(7, frame).status.at(0).level, ros::DiagnosticStatus::kOk);
  EXPECT_EQ(ros_diagnostics(7, frame).status.at(0).message, "trusted");
  frame.report = report(Verdict::untrusted);
  EXPECT_EQ(ros_diagnostics(7, frame).status.at(0).level, ros::DiagnosticStatus::kError);
  frame.report.reset();
  EXPECT_EQ(ros_diagnostics(7, frame).status.at(0).level, ros::DiagnosticStatus::kStale);
}

TEST(RosReport, DescribesCalibratedCameras) {
  const Camera fisheye{CameraModel::equidistant, 752, 480, 458.0, 457.0, 367.0, 248.0, {0.1, 0.2, 0.3, 0.4}};
  const ros::CameraInfo info = ros_camera_info(fisheye, "left_camera", {});
  EXPECT_EQ(info.distortion_model, "equidistant");
  EXPECT_THAT(info.d, testing::ElementsAre(0.1, 0.2, 0.3, 0.4));
  EXPECT_EQ(info.k[2], 367.0);
  EXPECT_EQ(info.width, 752u);
}

}  // namespace
}  // namespace byre
