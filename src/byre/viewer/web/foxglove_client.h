#pragma once

#include "byre/io/ros/message_sink.h"
#include "byre/trajectory.h"
#include "byre/viewer/web/web_site.h"

#include <cstddef>
#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace byre {

// Subset of Foxglove's WebSocket protocol: channels of ROS 2 messages (encoding "cdr", schemas "ros2msg"),
// subscriptions, status and time. Text messages are JSON with the field "op"; binary messages are little-endian and
// begin with an opcode byte. See github.com/foxglove/ws-protocol, docs/spec.md.

// Newest supported sub-protocol of those offered ("a, b"); empty if none is supported.
std::string_view foxglove_protocol(std::string_view offered);

enum class StatusLevel : std::uint8_t { info, warning, error };

// session: constant for the lifetime of the server.
std::string server_info_text(std::string_view session);
// Channels of the topics from index `first` on. Channel id: index of the topic.
std::string advertise_text(std::size_t first, std::span<const ros::Topic> topics);
std::string status_text(StatusLevel level, std::string_view message);

// Header of a binary message.
std::string message_head(std::uint32_t subscription, Timestamp time);
std::string time_bytes(Timestamp time);

// Request of a client.
struct FoxgloveRequest {
  struct Subscription {
    std::uint32_t id = 0;  // chosen by the client
    std::uint32_t channel = 0;
    bool operator==(const Subscription&) const = default;
  };

  std::vector<Subscription> subscribe;
  std::vector<std::uint32_t> unsubscribe;  // ids of subscriptions
  std::string fault;                       // reason for ignoring the request; empty if valid
};

FoxgloveRequest read_foxglove_request(std::string_view bytes, bool is_binary);

struct FoxgloveLimits {
  std::size_t max_bytes = std::size_t{32} << 20;  // bytes of queued messages
  std::size_t max_messages = 500;                 // number of queued messages
  std::size_t max_answers = 64;  // number of queued answers; above, the client is disconnected as it never reads
};

// Subscriptions and output queue of a Foxglove client. For a slow client the oldest messages are dropped, with a status
// message. Owned by the server's thread.
class FoxgloveClient : public WebFeed {
 public:
  // The topics outlive this.
  FoxgloveClient(LiveTopics& topics, std::string_view session, const FoxgloveLimits& limits = {});
  ~FoxgloveClient() override;
  FoxgloveClient(const FoxgloveClient&) = delete;
  FoxgloveClient& operator=(const FoxgloveClient&) = delete;

  bool receive(std::string_view bytes, bool is_binary) override;

  // Queues a message if its topic is subscribed.
  void offer(const LiveMessage& message) override;

  std::optional<WebMessage> next() override;

 private:
  struct Waiting {
    std::uint32_t subscription = 0;
    bool is_new = false;  // accept no message older than the subscription
    LiveMessage message;
  };

  void subscribe(const FoxgloveRequest::Subscription& wanted);
  void unsubscribe(std::uint32_t id);
  void send_error(std::string_view reason);
  void add(Waiting waiting);
  void drop_oldest();

  LiveTopics& topics_;
  FoxgloveLimits limits_;  // constant after construction
  std::deque<std::string> answers_;
  std::size_t advertised_ = 0;                                     // topics advertised so far
  std::map<std::uint32_t, ros::MessageSink::TopicId> subscribed_;  // topics by subscription id
  std::deque<Waiting> waiting_;
  std::size_t waiting_bytes_ = 0;
  bool has_dropped_ = false;  // whether messages were dropped since the queue was empty
  Timestamp time_{};          // last time sent
};

}  // namespace byre
