#include "byre/ros2/dds/participant.h"

#include <algorithm>
#include <chrono>
#include <optional>

#include <gmock/gmock.h>
#include <unistd.h>

namespace byre {
namespace {

using std::chrono_literals::operator""s;
using std::chrono_literals::operator""ms;

const MessageType kText{"std_msgs/msg/String", ""};

std::vector<std::byte> message_of(std::size_t size) {
  std::vector<std::byte> message(size);
  for (std::size_t i = 0; i < size; ++i) message[i] = static_cast<std::byte>(i * 7 + i / 251);
  if (size > 1) message[0] = std::byte{0}, message[1] = std::byte{1};
  return message;
}

// Two participants on the loopback interface. Their domain ids differ inside Cyclone DDS, to prevent delivery within
// the process; on the wire they are equal.
class TwoParticipants : public testing::Test {
 protected:
  static std::string settings() {
    const int on_the_wire = 100 + static_cast<int>(getpid()) % 100;
    return "<CycloneDDS><Domain><Discovery><ExternalDomainId>" + std::to_string(on_the_wire) +
           "</ExternalDomainId></Discovery></Domain></CycloneDDS>";
  }
  static Participant participant(int number) {
    return Participant({.domain = number, .range = DiscoveryRange::localhost}, settings());
  }

  // Next message, waiting some seconds.
  std::optional<Message> next(Participant& participant, Subscriber& subscriber) {
    const auto end = std::chrono::steady_clock::now() + 20s;
    while (std::chrono::steady_clock::now() < end) {
      participant.wait(200ms);
      std::vector<Message> messages = subscriber.take();
      if (!messages.empty()) return std::move(messages.back());
    }
    return std::nullopt;
  }

  static bool becomes_subscribed(const Publisher& publisher, Participant& idle) {
    const auto end = std::chrono::steady_clock::now() + 20s;
    while (!publisher.has_subscribers() && std::chrono::steady_clock::now() < end) idle.wait(10ms);
    return publisher.has_subscribers();
  }

  Participant sender_ = participant(1);
  Participant receiver_ = participant(2);
};

TEST_F(TwoParticipants, DropMessagesAboveTheSizeLimitOfTheirTopic) {
  Publisher bounded = sender_.publish("/bounded", kText, {});
  Publisher unbounded = sender_.publish("/unbounded", kText, {});
  Subscriber bounded_in = receiver_.subscribe("/bounded", kText, {.max_bytes = 1000});
  Subscriber unbounded_in = receiver_.subscribe("/unbounded", kText, {});
  ASSERT_TRUE(becomes_subscribed(bounded, receiver_));
  ASSERT_TRUE(becomes_subscribed(unbounded, receiver_));
  for (Publisher* publisher : {&bounded, &unbounded}) publisher->publish(message_of(200'000));
  bounded.publish(message_of(1000));
  const auto long_one = next(receiver_, unbounded_in);
  ASSERT_TRUE(long_one);
  EXPECT_EQ(long_one->bytes().size(), 200'000u);
  const auto short_one = next(receiver_, bounded_in);
  ASSERT_TRUE(short_one);
  EXPECT_EQ(short_one->bytes().size(), 1000u);
  EXPECT_TRUE(bounded_in.take().empty());
}

TEST_F(TwoParticipants, ExchangeMessagesOfAnySizeUnchanged) {
  Publisher publisher = sender_.publish("/sizes", kText, {});
  Subscriber subscriber = receiver_.subscribe("/sizes", kText, {});
  ASSERT_TRUE(becomes_subscribed(publisher, sender_));
  for (const std::size_t size : {8u, 9u, 10u, 11u, 70'000u, 722'001u}) {
    publisher.publish(message_of(size));
    const auto message = next(receiver_, subscriber);
    ASSERT_TRUE(message.has_value()) << size;
    const auto bytes = message->bytes();
    ASSERT_GE(bytes.size(), size);
    EXPECT_LT(bytes.size(), size + 4) << "DDS fills the last four bytes up";
    EXPECT_TRUE(std::ranges::equal(bytes.first(size), message_of(size))) << size;
  }
  EXPECT_EQ(publisher.dropped(), 0);
}

TEST_F(TwoParticipants, SendLatchedMessagesToLateReaders) {
  Publisher latched = sender_.publish("/latched", kText, {.is_latched = true, .depth = 1});
  latched.publish(message_of(12));
  latched.publish(message_of(16));
  Subscriber late = receiver_.subscribe("/latched", kText, {.is_latched = true, .depth = 1});
  const auto message = next(receiver_, late);
  ASSERT_TRUE(message.has_value());
  EXPECT_EQ(message->bytes().size(), 16u) << "only the last message";
}

TEST_F(TwoParticipants, KeepTheNewestMessageForSlowReaders) {
  Publisher publisher = sender_.publish("/many", kText, {.is_reliable = true, .depth = 50});
  Subscriber subscriber = receiver_.subscribe("/many", kText, {.is_reliable = true, .depth = 2});
  ASSERT_TRUE(becomes_subscribed(publisher, sender_));
  for (std::size_t i = 1; i <= 20; ++i) publisher.publish(message_of(4 * i));
  std::size_t last = 0;
  while (last < 80) {
    const auto message = next(receiver_, subscriber);
    ASSERT_TRUE(message.has_value());
    ASSERT_GT(message->bytes().size(), last);
    last = message->bytes().size();
  }
}

TEST_F(TwoParticipants, DiscoverThePublishersOfOthers) {
  const MessageType image{"sensor_msgs/msg/Image", ""};
  const Publisher own = receiver_.publish("/seen", kText, {});
  const Subscriber reliable = receiver_.subscribe("/seen", kText, {.is_reliable = true});
  EXPECT_THAT(receiver_.publishers("/seen"), testing::IsEmpty()) << "not its own";
  {
    const Publisher text = sender_.publish("/seen", kText, {.is_reliable = false});
    const Publisher other_type = sender_.publish("/seen", image, {.is_reliable = true, .is_latched = true});
    const Publisher other_topic = sender_.publish("/unseen", kText, {});
    const auto end = std::chrono::steady_clock::now() + 20s;
    while (receiver_.publishers("/seen").size() < 2 && std::chrono::steady_clock::now() < end) receiver_.wait(10ms);
    EXPECT_THAT(receiver_.publishers("/seen"),
                testing::UnorderedElementsAre(DiscoveredPublisher{"std_msgs/msg/String", false, false},
                                              DiscoveredPublisher{"sensor_msgs/msg/Image", true, true}));
    EXPECT_EQ(reliable.publishers(), 1) << "only its own, which is reliable and of its type";
  }
  const auto end = std::chrono::steady_clock::now() + 20s;
  while (!receiver_.publishers("/seen").empty() && std::chrono::steady_clock::now() < end) receiver_.wait(10ms);
  EXPECT_THAT(receiver_.publishers("/seen"), testing::IsEmpty()) << "they are gone";
}

TEST_F(TwoParticipants, HaveDistinctIds) {
  const Publisher publisher = sender_.publish("/ids", kText, {});
  const Subscriber subscriber = receiver_.subscribe("/ids", kText, {});
  EXPECT_NE(publisher.id(), subscriber.id());
  const EntityId writer = publisher.id(), participant = sender_.id();
  EXPECT_TRUE(std::equal(writer.begin(), writer.begin() + 12, participant.begin())) << "of the same participant";
}

}  // namespace
}  // namespace byre
