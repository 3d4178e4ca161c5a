#include "byre/ros2/dds/ros_network.h"

#include <gmock/gmock.h>

namespace byre {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;

TEST(RosNames, AreConvertedToDdsNames) {
  EXPECT_EQ(dds_topic_name("/left/image_raw"), "rt/left/image_raw");
  EXPECT_EQ(dds_type_name("sensor_msgs/msg/Image"), "sensor_msgs::msg::dds_::Image_");
  EXPECT_EQ(dds_request_name("/byre/save"), "rq/byre/saveRequest");
  EXPECT_EQ(dds_reply_name("/byre/save"), "rr/byre/saveReply");
  EXPECT_EQ(ros_type_name("sensor_msgs::msg::dds_::Image_"), "sensor_msgs/msg/Image");
  EXPECT_EQ(ros_type_name("HelloWorld"), "");
  EXPECT_EQ(dds_type_name("std_srvs/srv/Trigger_Request"), "std_srvs::srv::dds_::Trigger_Request_");
}

TEST(RosNames, AreResolvedInTheNamespaceOfTheNode) {
  EXPECT_EQ(resolve_name("odometry", "/"), "/odometry");
  EXPECT_EQ(resolve_name("odometry", "/barn/robot_1"), "/barn/robot_1/odometry");
  EXPECT_EQ(resolve_name("/tf", "/barn"), "/tf");
}

TEST(RosNames, AreValidated) {
  EXPECT_THAT(fault_in_name("/"), IsEmpty());
  EXPECT_THAT(fault_in_name("/left/image_raw2"), IsEmpty());
  EXPECT_THAT(fault_in_name(""), HasSubstr("begin with a slash"));
  EXPECT_THAT(fault_in_name("left"), HasSubstr("begin with a slash"));
  EXPECT_THAT(fault_in_name("/left//image"), HasSubstr("two consecutive slashes"));
  EXPECT_THAT(fault_in_name("/left/"), HasSubstr("ends with a slash"));
  EXPECT_THAT(fault_in_name("/2nd"), HasSubstr("digit"));
  EXPECT_THAT(fault_in_name("/left-image"), HasSubstr("letters"));
  EXPECT_THAT(fault_in_name("/" + std::string(300, 'a')), HasSubstr("longer"));
}

}  // namespace
}  // namespace byre
