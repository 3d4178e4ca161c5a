#pragma once

#include "byre/input_error.h"
#include "byre/io/ros/message_bytes.h"
#include "byre/io/ros/messages.h"
#include "byre/pose_hint.h"
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

// Hint from a pose set by hand, in the frame of the message. Radius and turn are three sigmas, but at least 3 m and
// 1 rad, because a click on a map is imprecise. A zero quaternion permits any direction, as some programs other than
// RViz 2 send none. Empty without a finite position.
std::optional<PoseHint> hint_of(const ros::PoseWithCovarianceStamped& message);

}  // namespace byre
