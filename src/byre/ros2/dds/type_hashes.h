#pragma once

#include "byre/io/ros/message.h"
#include "byre/ros2/dds/ros_names.h"

#include <string_view>

namespace byre {

// Type hash of a message (REP-2011: RIHS01_ and 64 digits); empty for messages that are only sent as parts.
std::string_view type_hash(std::string_view type_name);

template <ros::Message T>
MessageType message_type() {
  return {std::string(T::kType), std::string(type_hash(T::kType))};
}

}  // namespace byre
