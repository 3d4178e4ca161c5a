// byre node beside another vendor's program that publishes the same topics and transforms.

#include "mqtt_peer.h"
#include "node_fixture.h"

#include <gmock/gmock.h>

namespace byre::testing_ros2 {
namespace {

// A map server, and a robot description with the cameras.
TEST_F(ByreNode, ReportsSecondPublishersOfMapAndCameras) {
  NodeProcess node(folder_, mission(), domain_);
  auto* const server = peer_.writer("rt/map", TypeSupport(new nav_msgs::msg::OccupancyGridPubSubType), {true, true, 1});
  auto* const fixed =
      peer_.writer("rt/tf_static", TypeSupport(new tf2_msgs::msg::TFMessagePubSubType), {true, true, 1});
  tf2_msgs::msg::TFMessage mounting;
  geometry_msgs::msg::TransformStamped transform;
  transform.header().frame_id("base_link");
  transform.child_frame_id("left_optical");
  transform.transform().rotation().w(1.0);
  mounting.transforms({transform});
  ASSERT_TRUE(FastPeer::has_subscriber(fixed) && is_connected()) << node.stderr_output();
  fixed->write(&mounting);
  nav_msgs::msg::OccupancyGrid grid;
  server->write(&grid);
  const auto reports = [&](const std::string& text) {
    return eventually([&] { return node.stderr_output().find(text) != std::string::npos; });
  };
  EXPECT_TRUE(
      reports("/map has a second publisher, of another node: stop it (such as map_server), or set "
              "grid.from_map: false"))
      << node.stderr_output();
  bool is_said = false;
  for (std::size_t i = 0; i < Room::shared().frames().size() && !is_said; ++i) {
    answer_to(feed_, odometry_, Room::shared().frames()[i]);
    is_said = node.stderr_output().find("another node publishes a transform to left_optical") != std::string::npos;
  }
  EXPECT_TRUE(is_said || reports("another node publishes a transform to left_optical")) << node.stderr_output();
  Transforms cameras(peer_, "rt/tf_static", kLatched);
  const auto own = cameras.find([](const auto& message) {
    return !message.transforms().empty() && message.transforms()[0].child_frame_id() == "right_optical";
  });
  EXPECT_TRUE(own.has_value()) << "only the frame without another publisher";
  EXPECT_EQ(node.stop(), 0);
}

}  // namespace
}  // namespace byre::testing_ros2
