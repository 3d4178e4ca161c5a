#pragma once

#include "byre/viewer/foxglove_protocol.h"
#include "byre/viewer/live_topics.h"

#include <deque>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace byre {

// What is sent at once: the head, then the rest.
struct FoxgloveOutput {
  std::string head;
  bool is_binary = false;
  std::shared_ptr<const std::vector<std::byte>> rest;  // null: the head is all
};

struct FoxgloveLimits {
  std::size_t most_bytes = std::size_t{32} << 20;  // bytes of messages that wait for a client
  std::size_t most_messages = 500;                 // messages that wait for a client
  std::size_t most_answers = 64;                   // answers that wait; who asks on and never reads is sent away
};

// What a client of Foxglove's protocol has asked for, and what it is to be sent. Messages for a slow client are left
// out, the oldest first, and it is told so. Owned by the server's thread.
class FoxgloveClient {
 public:
  // The topics outlive this.
  FoxgloveClient(LiveTopics& topics, std::string_view session, const FoxgloveLimits& limits = {});
  ~FoxgloveClient();
  FoxgloveClient(const FoxgloveClient&) = delete;
  FoxgloveClient& operator=(const FoxgloveClient&) = delete;

  // What it sends. False: it is to be sent away.
  bool receive(std::string_view bytes, bool is_binary);

  // A message of a topic, taken over where it is subscribed.
  void offer(const LiveMessage& message);

  // What it is to be sent next.
  std::optional<FoxgloveOutput> next();

 private:
  struct Waiting {
    std::uint32_t subscription = 0;
    bool is_new = false;  // no message from before the subscription
    LiveMessage message;
  };

  void subscribe(const FoxgloveRequest::Subscription& wanted);
  void unsubscribe(std::uint32_t id);
  void refuse(std::string_view reason);
  void add(Waiting waiting);
  void drop_oldest();

  LiveTopics& topics_;
  FoxgloveLimits limits_;  // constant after construction
  std::deque<std::string> answers_;
  std::size_t advertised_ = 0;                                     // topics that it was told of
  std::map<std::uint32_t, ros::MessageSink::TopicId> subscribed_;  // topics by the ids of subscriptions
  std::deque<Waiting> waiting_;
  std::size_t waiting_bytes_ = 0;
  bool leaves_out_ = false;  // whether messages were left out since none waited
  Timestamp time_{};         // time that it was told last
};

}  // namespace byre
