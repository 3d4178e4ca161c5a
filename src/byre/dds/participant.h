#pragma once

#include "byre/dds/ros_names.h"
#include "byre/dds/ros_network.h"

#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

struct ddsi_serdata;
struct ddsi_sertype;

namespace byre {

// What is asked of a topic. Both sides must fit: who reads reliably needs a reliable writer, who reads what was written
// before it came needs a latched one.
struct TopicQos {
  bool is_reliable = true;
  bool is_latched = false;  // whether the last messages are kept for those who come later ("transient local")
  int depth = 10;           // messages kept for a reader that is slow
  std::size_t most_bytes = std::size_t{128} << 20;  // longer received messages are dropped
};

// Largest received message without an image: commands, poses, camera calibrations, motion, transforms.
inline constexpr std::size_t kMostBytesWithoutImage = std::size_t{256} << 10;

// A 16-byte id of DDS.
using EntityId = std::array<std::uint8_t, 16>;

// Something of Cyclone DDS, deleted with it.
class DdsEntity {
 public:
  DdsEntity() = default;
  // doing: what was asked for, for messages. Throws std::runtime_error for an error's number.
  DdsEntity(std::int32_t handle, const std::string& doing);
  DdsEntity(DdsEntity&& other) noexcept : handle_(std::exchange(other.handle_, 0)) {}
  DdsEntity& operator=(DdsEntity&& other) noexcept;
  ~DdsEntity();

  std::int32_t handle() const { return handle_; }

 private:
  std::int32_t handle_ = 0;  // zero: none
};

// Messages of one topic on their way out. Made by a Participant.
class Publisher {
 public:
  // Hands a message over, as CDR. Waits a little for readers that are slow, then leaves it out.
  void publish(std::vector<std::byte> message);

  int subscribers() const;
  bool has_subscribers() const { return subscribers() > 0; }
  EntityId id() const;
  int left_out() const { return left_out_; }  // messages

 private:
  friend class Participant;
  const ddsi_sertype* type_ = nullptr;  // constant after construction, held by the topic
  DdsEntity topic_;
  DdsEntity writer_;
  int left_out_ = 0;
};

// A message that came in. Its bytes stay where they are as long as it lives.
class Message {
 public:
  explicit Message(ddsi_serdata* taken) : taken_(taken) {}
  Message(Message&& other) noexcept : taken_(std::exchange(other.taken_, nullptr)) {}
  Message& operator=(Message&& other) noexcept;
  ~Message();

  std::span<const std::byte> bytes() const;

 private:
  ddsi_serdata* taken_ = nullptr;
};

// Messages of one topic on their way in. Made by a Participant.
class Subscriber {
 public:
  // All that came since it was asked last, the oldest first; no more than the topic's depth.
  std::vector<Message> take();

  int publishers() const;
  EntityId id() const;

 private:
  friend class Participant;
  DdsEntity topic_;
  DdsEntity reader_;
  DdsEntity condition_;
};

// A program in a domain of ROS 2, by Cyclone DDS, which has threads of its own: call this from one thread. Publishers
// and subscribers are to be gone before it. All throw std::runtime_error for what DDS refuses.
class Participant {
 public:
  // own_settings: CYCLONEDDS_URI. One at a time in a program may have a domain of one number.
  Participant(const RosNetwork& network, const std::string& own_settings);

  // topic: begins with a slash, or is a name of DDS as it is. note: what other programs are told of the writer or
  // reader beside its type, as "key=value;".
  Publisher publish(const std::string& topic, const MessageType& type, const TopicQos& qos,
                    const std::string& note = {});
  // Its messages wake wait().
  Subscriber subscribe(const std::string& topic, const MessageType& type, const TopicQos& qos,
                       const std::string& note = {});

  // The types of all that is published on a topic, as is known by now: "nav_msgs/msg/Odometry".
  std::vector<std::string> published_types(const std::string& topic);

  // Until a subscriber has messages, at longest for a time.
  void wait(std::chrono::nanoseconds longest);

  EntityId id() const;
  RosDistribution distribution() const { return distribution_; }

 private:
  RosDistribution distribution_;  // constant after construction
  DdsEntity domain_;
  DdsEntity participant_;
  DdsEntity wake_;
  DdsEntity publications_;  // reader of what others publish, once it is asked for
};

}  // namespace byre
