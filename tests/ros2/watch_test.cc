// byre node watched by a Foxglove client, on the port of /healthz and /metrics.

#include "byre/io/ros/message_bytes.h"
#include "byre/io/ros/messages.h"
#include "byre/viewer/web/web_client_scene.h"
#include "node_fixture.h"

#include <map>
#include <optional>
#include <span>
#include <string>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace byre::testing_ros2 {
namespace {

// Subscribes to topics and reads their messages.
class Watcher {
 public:
  explicit Watcher(int port) : client_(port, "/", {{"Sec-WebSocket-Protocol", "foxglove.sdk.v1"}}) {
    client_.next();  // serverInfo
    const nlohmann::json advertise = client_.next().json();
    for (const auto& channel : advertise.at("channels")) ids_[channel.at("topic")] = channel.at("id");
  }

  void subscribe(const std::string& topic) {
    const int id = ids_.at(topic);
    const nlohmann::json request = {{"op", "subscribe"}, {"subscriptions", {{{"id", id}, {"channelId", id}}}}};
    client_.send(request.dump());
  }

  // Returns once the server has processed all requests.
  void settle() {
    client_.send("hello");
    while (client_.next().is_binary) {
    }
  }

  // The message of a topic at a time; skips others.
  template <ros::Message M>
  M message(const std::string& topic, Timestamp time) {
    constexpr std::size_t kHead = 13;
    std::string head(1, '\1');
    const auto append = [&head](std::uint64_t value, int bytes) {
      for (int i = 0; i < bytes; ++i) head += static_cast<char>(value >> (8 * i));
    };
    append(static_cast<std::uint64_t>(ids_.at(topic)), 4);
    append(static_cast<std::uint64_t>(time.count()), 8);
    for (;;) {
      const LiveClient::Message message = client_.next();
      if (!message.is_binary || !message.bytes.starts_with(head)) continue;
      const std::string cdr = message.bytes.substr(kHead);
      return ros::read_message<M>(std::as_bytes(std::span(cdr)), ros::Encoding::cdr, topic);
    }
  }

 private:
  LiveClient client_;
  std::map<std::string, int> ids_;
};

TEST_F(ByreNode, SendsTheSameMessagesToFoxgloveAndReaders) {
  const int port = free_port();
  const NodeProcess node(folder_, mapping() + "http:\n  port: " + std::to_string(port) + "\n", domain_);
  ASSERT_TRUE(is_connected()) << node.stderr_output();
  Watcher watcher(port);
  watcher.subscribe("/left/image_raw");
  watcher.subscribe("/byre/odometry");
  watcher.settle();
  const ImageFrame* answered = nullptr;
  std::optional<nav_msgs::msg::Odometry> answer;
  for (const ImageFrame& frame : Room::shared().frames()) {
    answer = answer_to(feed_, odometry_, frame);
    answered = &frame;
    if (answer) break;
  }
  ASSERT_TRUE(answer) << node.stderr_output();
  const auto image = watcher.message<ros::Image>("/left/image_raw", answered->time);
  EXPECT_EQ(image.data, answered->left.pixels);
  const auto odometry = watcher.message<ros::Odometry>("/byre/odometry", answered->time);
  EXPECT_EQ(odometry.header.frame_id, answer->header().frame_id());
  EXPECT_EQ(odometry.pose.pose.position.x, answer->pose().pose().position().x());
  EXPECT_EQ(odometry.pose.pose.position.z, answer->pose().pose().position().z());
  EXPECT_EQ(odometry.pose.covariance[0], answer->pose().covariance()[0]);
}

}  // namespace
}  // namespace byre::testing_ros2
