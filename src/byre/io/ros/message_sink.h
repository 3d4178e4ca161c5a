#pragma once

#include "byre/io/ros/message_bytes.h"
#include "byre/io/ros/message_schema.h"

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace byre::ros {

// Whether late subscribers receive the last message of a topic.
enum class Durability : std::uint8_t { only_new, latched };

struct Topic {
  std::string name;    // begins with a slash
  std::string type;    // with package: "nav_msgs/msg/Odometry"
  std::string schema;  // definition, see message_schema()
  Durability durability = Durability::only_new;
};

template <Message M>
Topic topic_of(const std::string& name, Durability durability = Durability::only_new) {
  return {name, std::string(M::kType), message_schema<M>(), durability};
}

// Receiver of ROS 2 messages: a file or live subscribers.
class MessageSink {
 public:
  using TopicId = std::uint16_t;

  MessageSink() = default;
  MessageSink(const MessageSink&) = delete;
  MessageSink& operator=(const MessageSink&) = delete;
  virtual ~MessageSink() = default;

  virtual TopicId add(Topic topic) = 0;

  // Whether the topic has a receiver, so that a message is worth making.
  virtual bool is_wanted(TopicId topic) const = 0;

  virtual void put(TopicId topic, std::chrono::nanoseconds time, std::vector<std::byte> cdr) = 0;

  template <Message M>
  void put_message(TopicId topic, std::chrono::nanoseconds time, const M& message) {
    put(topic, time, write_message(message, Encoding::cdr));
  }

 protected:
  MessageSink(MessageSink&&) = default;
  MessageSink& operator=(MessageSink&&) = default;
};

}  // namespace byre::ros
