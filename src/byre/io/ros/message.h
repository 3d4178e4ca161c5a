#pragma once

#include <concepts>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <type_traits>

namespace byre::ros {

// Struct of messages.h with a type name and a list of fields.
template <typename T>
concept Message = requires {
  { T::kType } -> std::convertible_to<std::string_view>;
};

// Field with equal layout in memory and on the wire.
template <typename T>
concept Number = std::is_arithmetic_v<T> || std::same_as<T, std::byte>;

// Serialisation of messages.
//   cdr   ROS 2: four bytes for the byte order, then XCDR1, with padding; strings end with a zero
//   ros1  ROS 1: little-endian, without padding
enum class Encoding : std::uint8_t { cdr, ros1 };

// Type name of ROS 1 and message definitions: "sensor_msgs/Image" for "sensor_msgs/msg/Image"; other names are
// unchanged.
std::string short_type(std::string_view type);

}  // namespace byre::ros
