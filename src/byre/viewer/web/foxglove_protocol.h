#pragma once

#include "byre/io/ros/message_sink.h"
#include "byre/trajectory.h"

#include <cstddef>
#include <cstdint>
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

}  // namespace byre
