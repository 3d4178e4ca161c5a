#include "byre/io/ros/message_bytes.h"
#include "byre/io/ros/messages.h"
#include "byre/viewer/web/web_client_scene.h"
#include "byre/viewer/web/web_server.h"

#include <memory>
#include <span>
#include <string>
#include <thread>
#include <vector>

#include <gmock/gmock.h>

namespace byre {
namespace {

using ::testing::HasSubstr;

class EmptySite : public WebSite {
 public:
  WebResponse answer(const WebRequest& request) override { return not_found(request); }
};

class FoxgloveServerTest : public testing::Test {
 protected:
  WebServer serve(const std::string& address = "127.0.0.1") {
    return {{address, 0, {}}, std::make_unique<EmptySite>(), topics_};
  }
  static LiveClient connect(const WebServer& server, const std::string& offered = "foxglove.websocket.v1") {
    return LiveClient(server.port(), "/", {{"Sec-WebSocket-Protocol", offered}});
  }
  static void subscribe(LiveClient& client) {
    client.send(R"({"op":"subscribe","subscriptions":[{"id":7,"channelId":0}]})");
  }

  std::shared_ptr<LiveTopics> topics_ = std::make_shared<LiveTopics>();
  LiveTopics::TopicId words_ = topics_->add(ros::topic_of<ros::String>("/words", ros::Durability::latched));
};

TEST_F(FoxgloveServerTest, SelectsTheRequestedProtocol) {
  const WebServer server = serve();
  EXPECT_EQ(connect(server).protocol(), "foxglove.websocket.v1");
  EXPECT_EQ(connect(server, "foxglove.websocket.v1, foxglove.sdk.v1").protocol(), "foxglove.sdk.v1");
  EXPECT_THROW(connect(server, "another"), boost::system::system_error);
}

TEST_F(FoxgloveServerTest, SendsTheSameSessionToAllAndMessagesUnchanged) {
  WebServer server = serve();
  LiveClient client = connect(server);
  LiveClient another = connect(server);
  EXPECT_EQ(client.next().json(), another.next().json());
  EXPECT_EQ(client.next().json().at("channels")[0].at("topic"), "/words");
  const ros::String sent{"here I am"};
  topics_->put_message(words_, Timestamp(5), sent);
  server.wake();
  subscribe(client);
  LiveClient::Message message = client.next();
  if (message.bytes[0] == 2) message = client.next();  // time, if subscribed before the server took the message
  ASSERT_TRUE(message.is_binary);
  ASSERT_GT(message.bytes.size(), 13u);
  EXPECT_EQ(message.bytes.substr(0, 13), std::string("\x01\x07\0\0\0\x05\0\0\0\0\0\0\0", 13));
  const std::string cdr = message.bytes.substr(13);
  EXPECT_EQ(ros::read_message<ros::String>(std::as_bytes(std::span(cdr)), ros::Encoding::cdr, "/words"), sent);
}

TEST_F(FoxgloveServerTest, AnswersInvalidRequestsAndContinues) {
  const WebServer server = serve();
  LiveClient client = connect(server);
  client.next();
  client.next();
  client.send("nonsense");
  EXPECT_THAT(client.next().bytes, HasSubstr("not a JSON object"));
  client.send("\x01nonsense", true);
  EXPECT_THAT(client.next().bytes, HasSubstr("accepts no messages"));
}

TEST_F(FoxgloveServerTest, ClosesOnTooLongMessages) {
  const WebServer server = serve();
  LiveClient client = connect(server);
  client.next();
  client.next();
  const auto talk = [&client] {  // the server may close before everything is sent
    client.send(std::string(100'000, ' '));
    client.next();
  };
  EXPECT_THROW(talk(), boost::system::system_error);
}

TEST_F(FoxgloveServerTest, NeverWaitsForAnIdleClient) {
  WebServer server = serve();
  LiveClient slow = connect(server), quick = connect(server);
  subscribe(slow);
  subscribe(quick);
  for (int i = 0; i < 2; ++i) quick.next();
  while (!topics_->is_wanted(words_)) std::this_thread::yield();
  for (int time = 1; time <= 60; ++time) {  // exceeds both socket buffers
    topics_->put(words_, Timestamp(time), std::vector<std::byte>(1 << 20));
    server.wake();
  }
  std::string last;
  while (last.substr(0, 6) != std::string("\x01\x07\0\0\0\x3c", 6)) last = quick.next().bytes;
  EXPECT_EQ(last.size(), 13u + (1u << 20));
}

TEST_F(FoxgloveServerTest, AcceptsOnlyOwnAndKnownPages) {
  const WebServer server = serve();
  const auto ask_from = [&server](const std::string& page) {
    LiveClient(server.port(), "/", {{"Sec-WebSocket-Protocol", "foxglove.sdk.v1"}, {"Origin", page}});
  };
  EXPECT_NO_THROW(ask_from("https://app.foxglove.dev"));
  EXPECT_THROW(ask_from("https://elsewhere.example"), boost::system::system_error);
}

TEST_F(FoxgloveServerTest, NeedsTheTokenThroughTheNetwork) {
  const WebServer server = serve("0.0.0.0");
  EXPECT_THROW(connect(server), boost::system::system_error);
  const std::string url = server.urls().back();
  const std::string target = url.substr(url.find("/?"));
  EXPECT_NO_THROW(LiveClient(server.port(), target, {{"Sec-WebSocket-Protocol", "foxglove.sdk.v1"}}));
}

TEST_F(FoxgloveServerTest, IsDisabledWithoutTopics) {
  const WebServer server({"127.0.0.1", 0, {}}, std::make_unique<EmptySite>());
  EXPECT_THROW(connect(server), boost::system::system_error);
}

}  // namespace
}  // namespace byre
