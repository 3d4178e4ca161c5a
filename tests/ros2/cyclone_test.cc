// `byre node` against programs of ROS 2 whose types Cyclone's generator made: transforms, two robots, late joiners,
// parameters. Images come from Fast DDS in the same domain.

#include "cyclone_peer.h"
#include "node_fixture.h"

#include <algorithm>

#include <gmock/gmock.h>

#include "cyclone_messages.h"

namespace byre::testing_ros2 {
namespace {

using std::chrono_literals::operator""ms;
using Transforms = tf2_msgs_msg_dds__TFMessage_;
using TransformMessage = geometry_msgs_msg_dds__TransformStamped_;

Pose pose_of(const TransformMessage& message) {
  const auto& [rotation, translation] = std::pair(message.transform.rotation, message.transform.translation);
  return {Eigen::Quaterniond(rotation.w, rotation.x, rotation.y, rotation.z),
          {translation.x, translation.y, translation.z}};
}

Timestamp time_of(const builtin_interfaces_msg_dds__Time_& time) {
  return std::chrono::seconds(time.sec) + std::chrono::nanoseconds(time.nanosec);
}

void send_transform(dds_entity_t writer, Timestamp time, std::string parent, std::string child, const Pose& pose) {
  TransformMessage message{};
  message.header.stamp.sec = static_cast<std::int32_t>(time.count() / 1'000'000'000);
  message.header.stamp.nanosec = static_cast<std::uint32_t>(time.count() % 1'000'000'000);
  message.header.frame_id = parent.data();
  message.child_frame_id = child.data();
  message.transform.translation = {pose.translation.x(), pose.translation.y(), pose.translation.z()};
  message.transform.rotation = {pose.rotation.x(), pose.rotation.y(), pose.rotation.z(), pose.rotation.w()};
  Transforms transforms{};
  transforms.transforms._maximum = transforms.transforms._length = 1;
  transforms.transforms._buffer = &message;
  ASSERT_EQ(dds_write(writer, &transforms), DDS_RETCODE_OK);
}

class ByreNodeWithCyclone : public ByreNode {
 protected:
  CyclonePeer cyclone_{domain_};
};

// A base driver owns odom -> base_link, which drifts and is reset half-way.
TEST_F(ByreNodeWithCyclone, ComputesMapToOdomFromABaseDriver) {
  const Room& room = Room::shared();
  const std::vector<FrameReport> expected =
      room.tracked(Slam::on_map(read_calibration(room.calibration()), room.map(), Room::options()));
  const dds_entity_t driver = cyclone_.writer("rt/tf", tf2_msgs_msg_dds__TFMessage__desc, kVolatile);
  const dds_entity_t received = cyclone_.reader("rt/tf", tf2_msgs_msg_dds__TFMessage__desc, kVolatile);
  Texts health(peer_, "rt/byre/health", kVolatile);
  NodeProcess node(folder_, mission(), domain_);
  ASSERT_TRUE(is_connected() && CyclonePeer::has_subscriber(driver)) << node.stderr_output();
  const auto odom_from_base = [&](std::size_t i) {
    const bool is_reset = i > expected.size() / 2;
    const Pose drift{rotation_exp({0.0, 0.0, 0.02 * static_cast<double>(i)}), {is_reset ? 5.0 : 1.0, 2.0, 0.0}};
    return drift * expected[i].map_from_body.value_or(Pose{});
  };
  constexpr Timestamp kFuture = 100ms;  // frames.future
  int compared = 0;
  const auto compare = [&](const Transforms& message) {
    for (std::uint32_t i = 0; i < message.transforms._length; ++i) {
      const TransformMessage& transform = message.transforms._buffer[i];
      if (std::string(transform.child_frame_id) != "odom") continue;
      const auto frame = std::ranges::find(expected, time_of(transform.header.stamp) - kFuture, &FrameReport::time);
      if (frame == expected.end() || frame->health.verdict == Verdict::untrusted) continue;
      const Pose map_from_base =
          pose_of(transform) * odom_from_base(static_cast<std::size_t>(frame - expected.begin()));
      EXPECT_LT((map_from_base.translation - frame->map_from_body->translation).norm(), 1e-3) << "metres";
      EXPECT_EQ(message.transforms._length, 1u) << "odom -> base_link belongs to the base driver";
      ++compared;
    }
    return false;
  };
  for (std::size_t i = 0; i < expected.size(); ++i) {
    send_transform(driver, expected[i].time, "odom", "base_link", odom_from_base(i));
    std::this_thread::sleep_for(20ms);
    feed_.send(room.frames()[i]);
    const std::string time = "\"time_ns\":" + std::to_string(expected[i].time.count());
    ASSERT_TRUE(health.find([&](const auto& text) { return text.data().find(time + ",") != std::string::npos; }))
        << "frame " << i << "\n"
        << node.stderr_output();
    take_until<Transforms>(received, compare, std::chrono::seconds(0));
  }
  take_until<Transforms>(received, compare, std::chrono::seconds(1));
  EXPECT_GT(compared, 20);
  EXPECT_EQ(node.stop(), 0);
}

TEST_F(ByreNodeWithCyclone, KeepsTwoRobotsApart) {
  const std::string robot = "topics:\n  in_namespace: true\nnode:\n  namespace: /robot";
  fs::create_directories(folder_ / "second");
  const dds_entity_t first = cyclone_.reader("rt/robot1/tf", tf2_msgs_msg_dds__TFMessage__desc, kVolatile);
  const dds_entity_t second = cyclone_.reader("rt/robot2/tf", tf2_msgs_msg_dds__TFMessage__desc, kVolatile);
  const dds_entity_t of_all = cyclone_.reader("rt/tf", tf2_msgs_msg_dds__TFMessage__desc, kVolatile);
  NodeProcess node(folder_, mission(robot + "1\n"), domain_);
  NodeProcess other(folder_ / "second", mission(robot + "2\n"), domain_);
  const auto is_to_base = [](const Transforms& message) {
    const auto* const begin = message.transforms._buffer;
    return std::any_of(begin, begin + message.transforms._length,
                       [](const auto& each) { return std::string(each.child_frame_id) == "base_link"; });
  };
  bool is_first = false, is_second = false;
  for (int i = 0; i < 200 && !(is_first && is_second); ++i) {
    feed_.send(Room::shared().frames()[0], 100ms * i);
    std::this_thread::sleep_for(100ms);
    is_first = is_first || take_until<Transforms>(first, is_to_base, std::chrono::seconds(0));
    is_second = is_second || take_until<Transforms>(second, is_to_base, std::chrono::seconds(0));
  }
  EXPECT_TRUE(is_first) << node.stderr_output();
  EXPECT_TRUE(is_second) << other.stderr_output();
  EXPECT_FALSE(take_until<Transforms>(
      of_all, [](const Transforms&) { return true; }, std::chrono::seconds(0)));
  EXPECT_EQ(node.stop(), 0);
  EXPECT_EQ(other.stop(), 0);
}

TEST_F(ByreNodeWithCyclone, ServesLateJoinersAndParameters) {
  NodeProcess node(folder_, "node:\n  services: true\n" + mission(), domain_);
  ASSERT_TRUE(is_connected()) << node.stderr_output();
  for (std::size_t i = 0; i < 5; ++i) {
    ASSERT_TRUE(answer_to(feed_, odometry_, Room::shared().frames()[i])) << node.stderr_output();
  }
  const dds_entity_t fixed = cyclone_.reader("rt/tf_static", tf2_msgs_msg_dds__TFMessage__desc, kLatched);
  EXPECT_TRUE(take_until<Transforms>(fixed, [](const Transforms& message) { return message.transforms._length == 2; }));

  const dds_entity_t ask = cyclone_.writer("rq/byre/list_parametersRequest",
                                           rcl_interfaces_srv_dds__ListParameters_Request__desc, kVolatile);
  const dds_entity_t replies =
      cyclone_.reader("rr/byre/list_parametersReply", rcl_interfaces_srv_dds__ListParameters_Response__desc, kVolatile);
  ASSERT_TRUE(CyclonePeer::has_subscriber(ask)) << node.stderr_output();
  using Request = rcl_interfaces_srv_dds__ListParameters_Request_;
  using Response = rcl_interfaces_srv_dds__ListParameters_Response_;
  std::vector<std::string> names;
  for (int number = 1; number <= 20 && names.empty(); ++number) {
    Request request{};
    request.client = 7;
    request.number = number;
    ASSERT_EQ(dds_write(ask, &request), DDS_RETCODE_OK);
    take_until<Response>(
        replies,
        [&](const Response& response) {
          if (response.client != 7) return false;
          const auto& found = response.result.names;
          names.assign(found._buffer, found._buffer + found._length);
          return true;
        },
        std::chrono::seconds(1));
  }
  EXPECT_THAT(names, testing::IsSupersetOf({"slam.map", "grid.resolution", "mqtt.port"}));
  EXPECT_EQ(node.stop(), 0);
}

}  // namespace
}  // namespace byre::testing_ros2
