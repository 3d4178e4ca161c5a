#pragma once

#include "byre/io/ros/message_bytes.h"

namespace byre::ros {

// Messages are equal if their bytes are. ROS 1, because its headers have one field more.
template <Message T>
bool operator==(const T& one, const T& other) {
  return write_message(one, Encoding::ros1) == write_message(other, Encoding::ros1);
}

}  // namespace byre::ros
