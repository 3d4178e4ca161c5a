#include "byre/viewer/web/foxglove_client.h"

#include "byre/io/ros/messages.h"

#include <random>
#include <string>

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

namespace byre {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;
using ::testing::SizeIs;
using Json = nlohmann::json;
using Subscription = FoxgloveRequest::Subscription;

FoxgloveRequest read(std::string_view text) {
  return read_foxglove_request(text, false);
}

TEST(FoxgloveProtocol, SelectsTheNewestOfferedVersion) {
  EXPECT_EQ(foxglove_protocol("foxglove.websocket.v1"), "foxglove.websocket.v1");
  EXPECT_EQ(foxglove_protocol("other, foxglove.websocket.v1 ,foxglove.sdk.v1"), "foxglove.sdk.v1");
  for (const char* offered : {"", ",", "foxglove.websocket.v2", "foxglove.sdk.v1x", "other"}) {
    EXPECT_THAT(foxglove_protocol(offered), IsEmpty()) << offered;
  }
}

TEST(FoxgloveProtocol, DescribesTheServer) {
  const Json info = Json::parse(server_info_text("abc"));
  EXPECT_EQ(info.at("op"), "serverInfo");
  EXPECT_THAT(info.at("name").get<std::string>(), HasSubstr("byre"));
  EXPECT_EQ(info.at("capabilities"), Json({"time"}));
  EXPECT_EQ(info.at("sessionId"), "abc");
}

TEST(FoxgloveProtocol, AdvertisesTopicsWithRos2Schemas) {
  const std::vector<ros::Topic> topics = {ros::topic_of<ros::String>("/words"), ros::topic_of<ros::Odometry>("/odom")};
  const Json advertise = Json::parse(advertise_text(3, topics));
  EXPECT_EQ(advertise.at("op"), "advertise");
  ASSERT_THAT(advertise.at("channels"), SizeIs(2));
  const Json& words = advertise.at("channels")[0];
  EXPECT_EQ(words.at("id"), 3);
  EXPECT_EQ(words.at("topic"), "/words");
  EXPECT_EQ(words.at("encoding"), "cdr");
  EXPECT_EQ(words.at("schemaEncoding"), "ros2msg");
  EXPECT_EQ(words.at("schemaName"), "std_msgs/msg/String");
  EXPECT_EQ(words.at("schema"), "string data\n");
  EXPECT_EQ(advertise.at("channels")[1].at("id"), 4);
}

TEST(FoxgloveProtocol, WritesLittleEndianNumbers) {
  EXPECT_EQ(message_head(0x01020304, Timestamp(0x1122334455667788)),
            std::string("\x01\x04\x03\x02\x01\x88\x77\x66\x55\x44\x33\x22\x11", 13));
  EXPECT_EQ(time_bytes(Timestamp(0x0102)), std::string("\x02\x02\x01\0\0\0\0\0\0", 9));
}

TEST(FoxgloveProtocol, ReplacesInvalidUtf8InStatus) {
  const Json status = Json::parse(status_text(StatusLevel::error, "bad \xff"));
  EXPECT_EQ(status.at("op"), "status");
  EXPECT_EQ(status.at("level"), 2);
  EXPECT_THAT(status.at("message").get<std::string>(), HasSubstr("bad"));
}

TEST(FoxgloveProtocol, EscapesControlCharacters) {
  EXPECT_THAT(server_info_text("a\xc2\x9b"
                               "2J"),
              HasSubstr(R"("a\u009b2J")"));
}

TEST(FoxgloveProtocol, ReadsSubscriptions) {
  const FoxgloveRequest request =
      read(R"({"op":"subscribe","subscriptions":[{"id":0,"channelId":3},{"id":4294967295,"channelId":5}]})");
  EXPECT_THAT(request.fault, IsEmpty());
  EXPECT_THAT(request.subscribe, ElementsAre(Subscription{0, 3}, Subscription{4294967295, 5}));
  EXPECT_THAT(read(R"({"op":"unsubscribe","subscriptionIds":[0,7]})").unsubscribe, ElementsAre(0, 7));
}

TEST(FoxgloveProtocol, RejectsInvalidRequests) {
  const char* const messages[] = {
      "",
      "null",
      "[]",
      "7",
      "{",
      "\xff",
      R"({"op":7})",
      R"({"op":"subscribe"})",
      R"({"op":"subscribe","subscriptions":{"id":1,"channelId":1}})",
      R"({"op":"subscribe","subscriptions":[{"id":1,"channelId":1},{"id":2}]})",
      R"({"op":"subscribe","subscriptions":[[1,2]]})",
      R"({"op":"subscribe","subscriptions":[{"id":-1,"channelId":1}]})",
      R"({"op":"subscribe","subscriptions":[{"id":1.5,"channelId":1}]})",
      R"({"op":"subscribe","subscriptions":[{"id":4294967296,"channelId":1}]})",
      R"({"op":"subscribe","subscriptions":[{"id":1,"channelId":1e300}]})",
      R"({"op":"unsubscribe"})",
      R"({"op":"unsubscribe","subscriptionIds":["1"]})",
      R"({"op":"unsubscribe","subscriptionIds":[null]})",
      R"({"op":"advertise","channels":[]})",
  };
  for (const char* const message : messages) {
    const FoxgloveRequest request = read(message);
    EXPECT_THAT(request.fault, Not(IsEmpty())) << message;
    EXPECT_THAT(request.subscribe, IsEmpty()) << message;
    EXPECT_THAT(request.unsubscribe, IsEmpty()) << message;
  }
  EXPECT_THAT(read_foxglove_request(R"({"op":"subscribe","subscriptions":[]})", true).fault, Not(IsEmpty()));
}

TEST(FoxgloveProtocol, QuotesUnknownTextBriefly) {
  EXPECT_THAT(read(R"({"op":")" + std::string(10'000, 'x') + "\"}").fault.size(), testing::Lt(120u));
}

TEST(FoxgloveProtocol, SurvivesNestingAndMutation) {
  EXPECT_THAT(read(std::string(60'000, '[')).fault, Not(IsEmpty()));
  EXPECT_THAT(read(std::string(30'000, '[') + std::string(30'000, ']')).fault, Not(IsEmpty()));
  const std::string sound = R"({"op":"subscribe","subscriptions":[{"id":1,"channelId":2}]})";
  std::mt19937 random(7);
  for (int i = 0; i < 2000; ++i) {
    std::string message = sound;
    for (int change = 0; change < 3; ++change) message[random() % message.size()] = static_cast<char>(random());
    const FoxgloveRequest request = read(message);
    EXPECT_TRUE(!request.fault.empty() || request.subscribe.size() <= 1) << message;
  }
}

}  // namespace
}  // namespace byre
