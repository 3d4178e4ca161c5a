#include "byre/viewer/web/foxglove_client.h"

#include "byre/io/ros/messages.h"

#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

namespace byre {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::StartsWith;
using Json = nlohmann::json;

class FoxgloveClientTest : public testing::Test {
 protected:
  static constexpr FoxgloveLimits kLimits{.max_bytes = 1000, .max_messages = 4, .max_answers = 3};

  void SetUp() override { received(); }  // drains the initial messages

  void subscribe(std::uint32_t id, std::uint32_t channel) {
    request({{"op", "subscribe"}, {"subscriptions", {{{"id", id}, {"channelId", channel}}}}});
  }
  bool request(const Json& request) { return client_.receive(request.dump(), false); }

  // Offers a message of a topic to the client.
  void put(LiveTopics::TopicId topic, int time, std::size_t size = 4) {
    topics_.put(topic, Timestamp(time), std::vector<std::byte>(size));
    for (const LiveMessage& message : topics_.take()) client_.offer(message);
  }

  // Output of the client: "status ...", "time T" or "message SUBSCRIPTION T".
  std::vector<std::string> received() {
    std::vector<std::string> all;
    while (const auto output = client_.next()) all.push_back(summary(*output));
    return all;
  }
  static std::string summary(const WebMessage& output) {
    if (!output.is_binary) {
      const Json text = Json::parse(output.bytes);
      return text.at("op").get<std::string>() + " " + text.value("message", std::string());
    }
    const auto byte_at = [&output](std::size_t place) { return std::to_string(int{output.bytes[place]}); };
    return output.rest ? "message " + byte_at(1) + " " + byte_at(5) : "time " + byte_at(1);
  }

  LiveTopics topics_;
  LiveTopics::TopicId passing_ = topics_.add(ros::topic_of<ros::String>("/passing"));
  LiveTopics::TopicId latched_ = topics_.add(ros::topic_of<ros::String>("/kept", ros::Durability::latched));
  FoxgloveClient client_{topics_, "session", kLimits};
};

TEST_F(FoxgloveClientTest, ReceivesServerInfoAndChannelsFirst) {
  FoxgloveClient client(topics_, "session");
  EXPECT_EQ(summary(*client.next()), "serverInfo ");
  EXPECT_EQ(Json::parse(client.next()->bytes).at("channels").size(), 2u);
  EXPECT_FALSE(client.next());
  topics_.add(ros::topic_of<ros::String>("/later"));
  EXPECT_EQ(Json::parse(client.next()->bytes).at("channels")[0].at("id"), 2);
}

TEST_F(FoxgloveClientTest, ReceivesSubscribedTopicsUntilItUnsubscribes) {
  put(passing_, 1);
  EXPECT_THAT(received(), IsEmpty());
  subscribe(9, passing_);
  put(passing_, 2);
  put(passing_, 2);
  put(passing_, 3);
  EXPECT_THAT(received(), ElementsAre("time 2", "message 9 2", "message 9 2", "time 3", "message 9 3"));
  put(passing_, 4);
  request({{"op", "unsubscribe"}, {"subscriptionIds", {9}}});
  EXPECT_FALSE(topics_.is_wanted(passing_));
  EXPECT_THAT(received(), IsEmpty());
}

TEST_F(FoxgloveClientTest, ReceivesTheLastMessageOfALatchedTopic) {
  put(latched_, 1);
  put(latched_, 2);
  subscribe(5, latched_);
  EXPECT_THAT(received(), ElementsAre("message 5 2"));
}

TEST_F(FoxgloveClientTest, ReceivesErrors) {
  subscribe(1, 7);
  EXPECT_THAT(received(), ElementsAre(HasSubstr("unknown channel 7")));
  subscribe(1, passing_);
  subscribe(1, latched_);
  subscribe(2, passing_);
  EXPECT_THAT(received(), ElementsAre(HasSubstr("1 is in use"), HasSubstr("0 is subscribed already")));
  request({{"op", "unsubscribe"}, {"subscriptionIds", {3}}});
  EXPECT_THAT(received(), ElementsAre(HasSubstr("unknown subscription 3")));
  EXPECT_TRUE(request({{"op", "getParameters"}}));
  EXPECT_THAT(received(), ElementsAre(StartsWith("status ")));
}

TEST_F(FoxgloveClientTest, IsDisconnectedIfItNeverReads) {
  for (int i = 0; i < 3; ++i) EXPECT_TRUE(client_.receive("nonsense", false));
  EXPECT_FALSE(client_.receive("nonsense", false));
  EXPECT_FALSE(client_.receive("nonsense", true));
}

TEST_F(FoxgloveClientTest, SkipsTheOldestMessagesWhenSlowAndIsWarnedOnce) {
  subscribe(1, passing_);
  for (int time = 1; time <= 9; ++time) put(passing_, time);
  EXPECT_THAT(received(), ElementsAre(HasSubstr("dropped"), "time 6", "message 1 6", "time 7", "message 1 7", "time 8",
                                      "message 1 8", "time 9", "message 1 9"));
  for (int time = 1; time <= 3; ++time) put(passing_, time, 600);
  EXPECT_THAT(received(), ElementsAre(HasSubstr("dropped"), "time 3", "message 1 3"));
}

TEST_F(FoxgloveClientTest, KeepsALatchedMapDespiteImages) {
  subscribe(1, passing_);
  subscribe(2, latched_);
  put(latched_, 1);
  for (int time = 2; time <= 9; ++time) put(passing_, time);
  EXPECT_THAT(received(), testing::Contains("message 2 1"));
}

TEST_F(FoxgloveClientTest, HasNoSubscriptionsAfterDisconnecting) {
  {
    FoxgloveClient another(topics_, "session");
    another.receive(R"({"op":"subscribe","subscriptions":[{"id":1,"channelId":0}]})", false);
    EXPECT_TRUE(topics_.is_wanted(passing_));
  }
  EXPECT_FALSE(topics_.is_wanted(passing_));
}

}  // namespace
}  // namespace byre
