#pragma once

#include "byre/io/ros/message_sink.h"
#include "byre/trajectory.h"

#include <cstddef>
#include <deque>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <vector>

namespace byre {

// Message for subscribers; they share its bytes.
struct LiveMessage {
  ros::MessageSink::TopicId topic = 0;
  Timestamp time{};
  std::shared_ptr<const std::vector<std::byte>> cdr;
};

// Queue from the thread of a run to the server's thread. put() never waits. Messages without subscribers are dropped,
// except the last one of a latched topic. If the server is slow, the oldest messages are dropped.
class LiveTopics : public ros::MessageSink {
 public:
  // max_bytes: size of the queue in bytes
  explicit LiveTopics(std::size_t max_bytes = std::size_t{64} << 20) : max_bytes_(max_bytes) {}

  // Called from any thread.
  TopicId add(ros::Topic topic) override;
  bool is_wanted(TopicId topic) const override;
  void put(TopicId topic, Timestamp time, std::vector<std::byte> cdr) override;

  // Called from the server's thread.
  std::vector<ros::Topic> topics_from(std::size_t first) const;
  bool has_topic(std::size_t topic) const;
  void subscribe(TopicId topic);  // once per subscriber
  void unsubscribe(TopicId topic);
  std::vector<LiveMessage> take();  // messages since the previous call, oldest first

  // Last message taken of a latched topic.
  std::optional<LiveMessage> latched(TopicId topic) const;

 private:
  bool is_latched(TopicId topic) const { return topics_[topic].durability == ros::Durability::latched; }
  void drop_oldest();

  std::size_t max_bytes_;  // constant after construction

  mutable std::mutex mutex_;  // guards the members below, up to latched_
  std::vector<ros::Topic> topics_;
  std::vector<int> subscribers_;  // numbers of subscribers, by topic
  std::deque<LiveMessage> waiting_;
  std::size_t waiting_bytes_ = 0;

  std::map<TopicId, LiveMessage> latched_;  // owned by the server's thread
};

}  // namespace byre
