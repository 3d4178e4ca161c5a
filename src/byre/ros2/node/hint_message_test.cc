#include "byre/ros2/node/message_parsing.h"

#include <limits>
#include <numbers>

#include <gtest/gtest.h>

namespace byre {
namespace {

ros::PoseWithCovarianceStamped clicked() {
  ros::PoseWithCovarianceStamped message;
  message.pose.pose.position = {4.0, -2.0, 0.0};
  message.pose.pose.orientation = {0.0, 0.0, 0.6, 0.8};
  message.pose.covariance[0] = message.pose.covariance[7] = 0.25;  // default of RViz
  message.pose.covariance[35] = 0.07;
  return message;
}

TEST(HintMessage, ContainsPositionAndHeading) {
  const PoseHint hint = *hint_of(clicked());
  EXPECT_EQ(hint.map_from_body.translation, Eigen::Vector3d(4.0, -2.0, 0.0));
  EXPECT_DOUBLE_EQ(hint.map_from_body.rotation.z(), 0.6);
  EXPECT_DOUBLE_EQ(hint.radius, 3.0);
  EXPECT_DOUBLE_EQ(hint.turn, 1.0);
}

TEST(HintMessage, HasTheRadiusOfItsCovariance) {
  auto message = clicked();
  message.pose.covariance[7] = 4.0;
  message.pose.covariance[35] = 0.25;
  EXPECT_DOUBLE_EQ(hint_of(message)->radius, 6.0);
  EXPECT_DOUBLE_EQ(hint_of(message)->turn, 1.5);
}

TEST(HintMessage, WithoutHeadingAllowsAnyHeading) {
  auto message = clicked();
  message.pose.pose.orientation = {0.0, 0.0, 0.0, 0.0};
  EXPECT_DOUBLE_EQ(hint_of(message)->turn, std::numbers::pi);
}

TEST(HintMessage, IsRejectedIfNotFinite) {
  auto message = clicked();
  message.pose.pose.position.y = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(hint_of(message));
}

}  // namespace
}  // namespace byre
