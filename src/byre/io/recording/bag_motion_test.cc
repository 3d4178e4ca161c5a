#include "byre/io/recording/bag_motion.h"

#include "byre/io/bag/bag_scene.h"
#include "byre/io/recording/folder_scene.h"

#include <limits>

#include <gmock/gmock.h>

namespace byre {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

constexpr const char* kOdometry = "/wheel/odometry";
constexpr const char* kImuData = "/imu/data";

Timestamp at_ms(int milliseconds) {
  return std::chrono::milliseconds(milliseconds);
}

SceneMessage odometry(const std::string& topic, int stamp_ms, int log_ms, double x) {
  ros::Odometry message{.header = {ros::to_time(at_ms(stamp_ms)), "odom"}, .child_frame_id = "base_link"};
  message.pose.pose.position = {x, 2.0, 0.0};
  message.pose.pose.orientation = {0.0, 0.0, 0.6, 0.8};
  return scene_message(topic, at_ms(log_ms), message);
}

SceneMessage imu(const std::string& topic, int stamp_ms, double rate) {
  ros::Imu message{.header = {ros::to_time(at_ms(stamp_ms)), "imu"}};
  message.angular_velocity = {0.1, rate, -0.3};
  return scene_message(topic, at_ms(stamp_ms + 2), message);
}

class BagMotions : public BagFolderTest {
 protected:
  SensorMotion read(const std::vector<SceneMessage>& messages, const OpenOptions& options) const {
    const auto bag = open_bag(write("walk.mcap", mcap_bytes(messages, "zstd")),
                              [&](std::string_view type) { return is_motion_type(type, options); });
    return read_bag_motion(*bag, options, "walk.mcap");
  }
  std::string read_error(const std::vector<SceneMessage>& messages, const OpenOptions& options) const {
    return error_of([&] { read(messages, options); });
  }
};

TEST_F(BagMotions, ReturnWheelsAndRatesAtHeaderTimes) {
  const SensorMotion motion = read({odometry(kOdometry, 1000, 1003, 0.5), imu(kImuData, 1005, 0.2),
                                    imu(kImuData, 1010, 0.25), odometry(kOdometry, 1020, 1023, 0.6)},
                                   {.wheels_topic = kOdometry, .imu_topic = kImuData});
  EXPECT_THAT(motion.warnings, IsEmpty());
  ASSERT_THAT(motion.samples.wheels, SizeIs(2));
  EXPECT_EQ(motion.samples.wheels[1].time, at_ms(1020));
  EXPECT_TRUE(motion.samples.wheels[1].world_from_body.translation.isApprox(Eigen::Vector3d(0.6, 2.0, 0.0)));
  EXPECT_NEAR(motion.samples.wheels[1].world_from_body.rotation.z(), 0.6, 1e-12);
  ASSERT_THAT(motion.samples.rates, SizeIs(2));
  EXPECT_EQ(motion.samples.rates[0].time, at_ms(1005));
  EXPECT_TRUE(motion.samples.rates[0].rate.isApprox(Eigen::Vector3d(0.1, 0.2, -0.3)));
}

SceneMessage twist(const std::string& topic, int stamp_ms, double ahead, double turning) {
  ros::TwistStamped message{.header = {ros::to_time(at_ms(stamp_ms)), "base_link"}};
  message.twist.linear = {ahead, 0.1, 0.0};
  message.twist.angular = {0.0, 0.0, turning};
  return scene_message(topic, at_ms(stamp_ms + 2), message);
}

TEST_F(BagMotions, ReadVelocitiesOfTwistTopics) {
  const SensorMotion motion = read({twist("/wheel/twist", 1000, 0.5, 0.2), twist("/wheel/twist", 1020, 0.6, 0.3),
                                    odometry(kOdometry, 1010, 1013, 0.5)},
                                   {.wheels_topic = "/wheel/twist"});
  EXPECT_THAT(motion.samples.wheels, IsEmpty());
  ASSERT_THAT(motion.samples.velocities, SizeIs(2));
  const BaseTwist& last = motion.samples.velocities.back();
  EXPECT_EQ(last.time, at_ms(1020));
  EXPECT_EQ(Eigen::Vector3d(last.vx, last.vy, last.wz), Eigen::Vector3d(0.6, 0.1, 0.3));
}

// A driver with constant default poses, and one that marks them as invalid by their covariance.
TEST_F(BagMotions, ReadVelocitiesOfOdometryWithoutPoses) {
  std::vector<SceneMessage> messages;
  for (int i = 0; i < 20; ++i) {
    ros::Odometry message{.header = {ros::to_time(at_ms(1000 + 20 * i)), "odom"}, .child_frame_id = "base_link"};
    message.pose.pose.orientation.w = 1.0;
    message.twist.twist.linear.x = i < 5 ? 0.0 : 0.5;
    messages.push_back(scene_message(kOdometry, at_ms(1002 + 20 * i), message));
    message.pose.covariance[0] = -1.0;
    message.pose.pose.position.x = i;
    messages.push_back(scene_message("/odom", at_ms(1002 + 20 * i), message));
  }
  for (const char* const topic : {kOdometry, "/odom"}) {
    const SensorMotion motion = read(messages, {.wheels_topic = topic});
    EXPECT_THAT(motion.samples.wheels, IsEmpty());
    EXPECT_THAT(motion.samples.velocities, SizeIs(20));
    EXPECT_THAT(motion.warnings, IsEmpty());
  }
}

TEST_F(BagMotions, AreReadOnRequestOnly) {
  const SensorMotion motion = read({odometry(kOdometry, 1000, 1003, 0.5), imu(kImuData, 1005, 0.2)}, {});
  EXPECT_THAT(motion.samples.wheels, IsEmpty());
  EXPECT_THAT(motion.samples.rates, IsEmpty());
}

TEST_F(BagMotions, ReadAccelerationsIfPresent) {
  std::vector<SceneMessage> messages;
  for (int i = 0; i < 3; ++i) {
    ros::Imu message{.header = {ros::to_time(at_ms(1000 + i)), "imu"}};
    if (i < 2) message.linear_acceleration = {0.1, -0.2, 9.8};
    if (i == 0) message.linear_acceleration_covariance[0] = -1.0;
    messages.push_back(scene_message(kImuData, at_ms(1002 + i), message));
  }
  const SensorMotion motion = read(messages, {.use_gyroscope = true});
  EXPECT_THAT(motion.samples.rates, SizeIs(3));
  ASSERT_THAT(motion.samples.accelerations, SizeIs(1));
  EXPECT_EQ(motion.samples.accelerations[0].time, at_ms(1001));
  EXPECT_EQ(motion.samples.accelerations[0].acceleration, Eigen::Vector3d(0.1, -0.2, 9.8));
}

TEST_F(BagMotions, SkipRatesMarkedAsNotMeasured) {
  std::vector<SceneMessage> messages;
  for (int i = 0; i < 3; ++i) {
    ros::Imu message{.header = {ros::to_time(at_ms(1000 + i)), "imu"}};
    message.angular_velocity_covariance[0] = -1.0;
    message.linear_acceleration = {0.1, -0.2, 9.8};
    messages.push_back(scene_message(kImuData, at_ms(1002 + i), message));
  }
  const SensorMotion motion = read(messages, {.use_gyroscope = true});
  EXPECT_THAT(motion.samples.rates, IsEmpty());
  EXPECT_THAT(motion.samples.accelerations, SizeIs(3));
  ASSERT_THAT(motion.warnings, SizeIs(1));
  EXPECT_THAT(motion.warnings.front(), AllOf(HasSubstr("walk.mcap: /imu/data: 3 messages"), HasSubstr("not measured")));
}

TEST_F(BagMotions, SelectTheOnlyGyroscopeButRejectTwo) {
  const OpenOptions options{.use_gyroscope = true};
  EXPECT_THAT(read({imu(kImuData, 1005, 0.2)}, options).samples.rates, SizeIs(1));
  const std::string error = read_error({imu(kImuData, 1005, 0.2), imu("/camera/imu", 1006, 0.2)}, options);
  EXPECT_THAT(error, AllOf(HasSubstr("/imu/data"), HasSubstr("/camera/imu")));
  EXPECT_THAT(error, HasSubstr("--imu-topic TOPIC"));
}

TEST_F(BagMotions, ReportTheAvailableTopics) {
  EXPECT_THAT(read_error({odometry(kOdometry, 1000, 1003, 0.5)}, {.wheels_topic = "/odom"}),
              AllOf(HasSubstr("has no nav_msgs/msg/Odometry or geometry_msgs/msg/TwistStamped or "),
                    HasSubstr(" messages on topic /odom; available topics of this type: /wheel/odometry")));
  EXPECT_THAT(read_error({imu(kImuData, 1005, 0.2)}, {.wheels_topic = "/odom"}), HasSubstr("of this type: none"));
}

TEST_F(BagMotions, SortSamplesByTime) {
  const SensorMotion motion = read(
      {odometry(kOdometry, 1000, 1003, 0.5), odometry(kOdometry, 1040, 1043, 0.7), odometry(kOdometry, 1020, 1050, 0.6),
       odometry(kOdometry, 1020, 1060, 0.6), odometry(kOdometry, 1060, 1070, std::numeric_limits<double>::quiet_NaN())},
      {.wheels_topic = kOdometry});
  ASSERT_THAT(motion.samples.wheels, SizeIs(3));
  EXPECT_EQ(motion.samples.wheels[1].time, at_ms(1020));
  EXPECT_THAT(motion.warnings, ElementsAre(HasSubstr("2 messages were recorded after later ones"),
                                           HasSubstr("1 messages have the time stamp of another one"),
                                           HasSubstr("1 messages are damaged")));
}

TEST_F(BagMotions, UseReceiveTimesWithoutHeaderTimes) {
  const SensorMotion motion =
      read({odometry(kOdometry, 0, 1003, 0.5), odometry(kOdometry, 0, 1023, 0.6)}, {.wheels_topic = kOdometry});
  ASSERT_THAT(motion.samples.wheels, SizeIs(2));
  EXPECT_EQ(motion.samples.wheels[1].time, at_ms(1023));
  EXPECT_THAT(motion.warnings, ElementsAre(HasSubstr("receive times are used")));
}

}  // namespace
}  // namespace byre
