#pragma once

#include "byre/dds/participant.h"
#include "byre/input_error.h"
#include "byre/ros/message_reader.h"

#include <optional>
#include <string>

namespace byre {

// A message that came in; empty for bytes that are none of its type, which anybody may send.
template <ros::Message T>
std::optional<T> parsed_message(const Message& message, const std::string& topic) {
  try {
    return ros::read_message<T>(message.bytes(), ros::Encoding::cdr, topic);
  } catch (const InputError&) {
    return std::nullopt;
  }
}

}  // namespace byre
