#pragma once

#include "byre/ros/message_sink.h"
#include "byre/trajectory.h"

#include <cstddef>
#include <deque>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <vector>

namespace byre {

// A message on its way to those who watch; its bytes are shared by them.
struct LiveMessage {
  ros::MessageSink::TopicId topic = 0;
  Timestamp time{};
  std::shared_ptr<const std::vector<std::byte>> cdr;
};

// Where the thread of a run leaves messages for those who watch, without waiting. Messages that nobody has subscribed
// are not kept, but for the last one of topics that say so. A server's thread takes them; where that is slow the oldest
// are left out.
class LiveTopics : public ros::MessageSink {
 public:
  // most_bytes: bytes of messages that wait to be taken
  explicit LiveTopics(std::size_t most_bytes = std::size_t{64} << 20) : most_bytes_(most_bytes) {}

  // Called from any thread.
  TopicId add(ros::Topic topic) override;
  bool is_wanted(TopicId topic) const override;
  void put(TopicId topic, Timestamp time, std::vector<std::byte> cdr) override;

  // Called from the server's thread.
  std::vector<ros::Topic> topics_from(std::size_t first) const;
  bool is_known(std::size_t topic) const;
  void subscribe(TopicId topic);  // once for each that watches
  void unsubscribe(TopicId topic);
  std::vector<LiveMessage> take();  // messages since it was called last, the oldest first

  // The last message that was taken of a topic that keeps it.
  std::optional<LiveMessage> kept(TopicId topic) const;

 private:
  bool is_kept(TopicId topic) const { return topics_[topic].durability == ros::Durability::kept; }
  void make_room();

  std::size_t most_bytes_;  // constant after construction

  mutable std::mutex mutex_;  // guards what follows
  std::vector<ros::Topic> topics_;
  std::vector<int> subscribers_;  // by topic
  std::deque<LiveMessage> waiting_;
  std::size_t waiting_bytes_ = 0;

  std::map<TopicId, LiveMessage> kept_;  // owned by the server's thread
};

}  // namespace byre
