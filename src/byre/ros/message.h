#pragma once

#include <concepts>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <type_traits>

namespace byre::ros {

// A struct of messages.h: a type name and a list of fields.
template <typename T>
concept Message = requires {
  { T::kType } -> std::convertible_to<std::string_view>;
};

// A field that lies on the wire as it does in memory.
template <typename T>
concept Number = std::is_arithmetic_v<T> || std::same_as<T, std::byte>;

// How messages lie in bytes:
//   cdr   of ROS 2: four bytes that say which byte comes first, then XCDR1, with padding; strings end with a zero
//   ros1  of ROS 1: lowest byte first, without padding
enum class Encoding : std::uint8_t { cdr, ros1 };

// "sensor_msgs/Image", as ROS 1 and definitions of messages name "sensor_msgs/msg/Image"; other names as they are.
std::string short_type(std::string_view type);

}  // namespace byre::ros
