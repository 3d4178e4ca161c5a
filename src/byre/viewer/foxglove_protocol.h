#pragma once

#include "byre/ros/message_sink.h"
#include "byre/trajectory.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace byre {

// The WebSocket protocol of Foxglove, as far as byre speaks it: channels of ROS 2 messages (encoding "cdr", schemas
// "ros2msg") that clients subscribe, status and time. Text is JSON with the field "op"; binary begins with a byte that
// says what it is, and has the lowest byte first. See github.com/foxglove/ws-protocol, docs/spec.md.

// The sub-protocol that byre takes of those that a client offers ("a, b"), the newer one first; empty: none of them.
std::string_view foxglove_protocol(std::string_view offered);

enum class StatusLevel : std::uint8_t { info, warning, error };

// session: the same text for as long as the server lives.
std::string server_info_text(std::string_view session);
// The channels of topics from a number on: a channel's id is its topic's number.
std::string advertise_text(std::size_t first, std::span<const ros::Topic> topics);
std::string status_text(StatusLevel level, std::string_view message);

// What stands before the bytes of a message.
std::string message_head(std::uint32_t subscription, Timestamp time);
std::string time_bytes(Timestamp time);

// What a client asks for.
struct FoxgloveRequest {
  struct Subscription {
    std::uint32_t id = 0;  // chosen by the client
    std::uint32_t channel = 0;
    bool operator==(const Subscription&) const = default;
  };

  std::vector<Subscription> subscribe;
  std::vector<std::uint32_t> unsubscribe;  // ids of subscriptions
  std::string fault;                       // reason why nothing is done; empty where all is well
};

FoxgloveRequest read_foxglove_request(std::string_view bytes, bool is_binary);

}  // namespace byre
