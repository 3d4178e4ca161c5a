#pragma once

#include "byre/ros2/dds/ros_network.h"

#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <utility>
#include <vector>

struct ddsi_serdata;
struct ddsi_sertype;

namespace byre {

// Quality of service of a topic. Reader and writer must match: reliable readers need reliable writers, latched readers
// need latched writers.
struct TopicQos {
  bool is_reliable = true;
  bool is_latched = false;                         // keeps the last messages for late subscribers ("transient local")
  int depth = 10;                                  // messages kept for a slow reader
  std::size_t max_bytes = std::size_t{128} << 20;  // longer received messages are dropped
  bool ignores_own = false;                        // readers only: no messages of the same participant
};

// Largest received message without an image: commands, poses, camera calibrations, motion, transforms.
inline constexpr std::size_t kMaxBytesWithoutImage = std::size_t{256} << 10;

// 16-byte GUID of DDS.
using EntityId = std::array<std::uint8_t, 16>;

// Publisher of another participant. Subscribers need the same type and at least this quality of service.
struct DiscoveredPublisher {
  std::string type;  // "nav_msgs/msg/Odometry"; empty if it is not a type of ROS
  bool is_reliable = true;
  bool is_latched = false;

  bool operator==(const DiscoveredPublisher&) const = default;
};

// Handle of a Cyclone DDS entity, deleted on destruction.
class DdsEntity {
 public:
  DdsEntity() = default;
  // doing: attempted action, for messages. Throws std::runtime_error if the handle is an error code.
  DdsEntity(std::int32_t handle, const std::string& doing);
  DdsEntity(DdsEntity&& other) noexcept : handle_(std::exchange(other.handle_, 0)) {}
  DdsEntity& operator=(DdsEntity&& other) noexcept;
  ~DdsEntity();

  std::int32_t handle() const { return handle_; }

 private:
  std::int32_t handle_ = 0;  // zero: no entity
};

// Writer of a topic. Made by a Participant.
class Publisher {
 public:
  // Publishes a CDR message. Waits briefly for slow readers, then drops it.
  void publish(std::vector<std::byte> message);

  int subscribers() const;
  bool has_subscribers() const { return subscribers() > 0; }
  EntityId id() const;
  int dropped() const { return dropped_; }  // dropped messages

 private:
  friend class Participant;
  const ddsi_sertype* type_ = nullptr;  // constant after construction; owned by the topic
  DdsEntity topic_;
  DdsEntity writer_;
  int dropped_ = 0;
};

// Received message. Its bytes stay valid for its lifetime.
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

// Reader of a topic. Made by a Participant.
class Subscriber {
 public:
  // Messages since the previous call, oldest first, at most the depth of the topic.
  std::vector<Message> take();

  int publishers() const;
  EntityId id() const;

 private:
  friend class Participant;
  DdsEntity topic_;
  DdsEntity reader_;
  DdsEntity condition_;
};

// Participant in a ROS 2 domain by Cyclone DDS, which has its own threads. Call it from one thread. It outlives its
// publishers and subscribers. All functions throw std::runtime_error for errors of DDS.
class Participant {
 public:
  // own_settings: CYCLONEDDS_URI. A process may have one participant per domain number at a time.
  Participant(const RosNetwork& network, const std::string& own_settings);

  // topic: ROS name with a leading slash, or a plain DDS name. note: user data of the writer or reader besides its
  // type, as "key=value;".
  Publisher publish(const std::string& topic, const MessageType& type, const TopicQos& qos,
                    const std::string& note = {});
  // Received messages wake wait().
  Subscriber subscribe(const std::string& topic, const MessageType& type, const TopicQos& qos,
                       const std::string& note = {});

  // Publishers of other participants on a topic, discovered so far.
  std::vector<DiscoveredPublisher> publishers(const std::string& topic);

  // Waits until a subscriber has messages, or for the given time.
  void wait(std::chrono::nanoseconds longest);

  EntityId id() const;
  RosDistribution distribution() const { return distribution_; }

 private:
  RosDistribution distribution_;  // constant after construction
  DdsEntity domain_;
  DdsEntity participant_;
  DdsEntity wake_;
  DdsEntity publications_;  // reader of discovered publications, made on first use
};

}  // namespace byre
