#include "byre/viewer/web/live_topics.h"

#include "byre/io/ros/message_matchers.h"
#include "byre/io/ros/messages.h"

#include <vector>

#include <gmock/gmock.h>

namespace byre {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

class LiveTopicsTest : public testing::Test {
 protected:
  static std::vector<int> taken(LiveTopics& topics) {
    std::vector<int> times;
    for (const LiveMessage& message : topics.take()) times.push_back(static_cast<int>(message.time.count()));
    return times;
  }
  static std::vector<std::byte> bytes(std::size_t count) { return std::vector<std::byte>(count); }

  LiveTopics topics_{100};
  LiveTopics::TopicId passing_ = topics_.add(ros::topic_of<ros::String>("/passing"));
  LiveTopics::TopicId latched_ = topics_.add(ros::topic_of<ros::String>("/kept", ros::Durability::latched));
};

TEST_F(LiveTopicsTest, AcceptMessagesOnlyWhileSubscribed) {
  EXPECT_FALSE(topics_.is_wanted(passing_));
  topics_.put(passing_, Timestamp(1), bytes(4));
  topics_.subscribe(passing_);
  EXPECT_TRUE(topics_.is_wanted(passing_));
  EXPECT_FALSE(topics_.is_wanted(latched_));
  topics_.put(passing_, Timestamp(2), bytes(4));
  EXPECT_THAT(taken(topics_), ElementsAre(2));
  EXPECT_THAT(taken(topics_), IsEmpty());
  topics_.unsubscribe(passing_);
  topics_.put(passing_, Timestamp(3), bytes(4));
  EXPECT_THAT(taken(topics_), IsEmpty());
}

TEST_F(LiveTopicsTest, KeepTheLastMessageOfLatchedTopics) {
  EXPECT_FALSE(topics_.latched(latched_));
  topics_.put(latched_, Timestamp(1), bytes(4));
  topics_.put(latched_, Timestamp(2), bytes(4));
  topics_.take();
  ASSERT_TRUE(topics_.latched(latched_));
  EXPECT_EQ(topics_.latched(latched_)->time, Timestamp(2));
  EXPECT_FALSE(topics_.latched(passing_));
}

TEST_F(LiveTopicsTest, DropTheOldestMessages) {
  topics_.subscribe(passing_);
  for (int time = 1; time <= 5; ++time) topics_.put(passing_, Timestamp(time), bytes(40));
  EXPECT_THAT(taken(topics_), ElementsAre(4, 5));
}

TEST_F(LiveTopicsTest, NeverDropTheLastMessageOfALatchedTopic) {
  topics_.subscribe(passing_);
  topics_.put(latched_, Timestamp(1), bytes(40));
  topics_.put(latched_, Timestamp(2), bytes(40));
  topics_.put(passing_, Timestamp(3), bytes(40));
  topics_.put(passing_, Timestamp(4), bytes(40));
  EXPECT_THAT(taken(topics_), ElementsAre(2, 4));
}

TEST_F(LiveTopicsTest, ListTopicsFromAnIndex) {
  ASSERT_EQ(topics_.topics_from(1).size(), 1u);
  EXPECT_EQ(topics_.topics_from(1)[0].name, "/kept");
  EXPECT_THAT(topics_.topics_from(2), IsEmpty());
  EXPECT_THAT(topics_.topics_from(3), IsEmpty());
  EXPECT_TRUE(topics_.has_topic(1));
  EXPECT_FALSE(topics_.has_topic(2));
}

}  // namespace
}  // namespace byre
