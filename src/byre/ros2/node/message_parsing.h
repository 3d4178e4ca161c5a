#pragma once

#include "byre/input_error.h"
#include "byre/io/ros/message_reader.h"
#include "byre/ros2/dds/participant.h"

#include <optional>
#include <string>

namespace byre {

// Parses a received message; empty for invalid bytes, as any peer may send.
template <ros::Message T>
std::optional<T> parsed_message(const Message& message, const std::string& topic) {
  try {
    return ros::read_message<T>(message.bytes(), ros::Encoding::cdr, topic);
  } catch (const InputError&) {
    return std::nullopt;
  }
}

}  // namespace byre
