#pragma once

#include "byre/io/ros/message.h"

#include <array>
#include <cstring>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace byre::ros {

// Smallest size of a value in either encoding.
template <typename T>
std::size_t min_size();

// Parses the fields of a message within bounds; allocates no more than the remaining bytes justify. Borrows the bytes.
// Throws InputError with the place "PLACE at byte N".
class MessageReader {
 public:
  // Throws InputError if cdr bytes lack the header of ROS 2.
  MessageReader(std::span<const std::byte> bytes, Encoding encoding, std::string place);

  template <typename T>
  void operator()(std::string_view /*name*/, T& value) {
    read(value);
  }
  void ros1_only(std::uint32_t& value) {
    if (encoding_ == Encoding::ros1) read(value);
  }

 private:
  template <Number T>
  void read(T& value) {
    read_all(std::span(&value, 1));
  }
  void read(bool& value);
  void read(std::string& text);
  template <Message T>
  void read(T& message) {
    T::fields(message, *this);
  }
  template <typename T, std::size_t n>
  void read(std::array<T, n>& values) {
    read_all(std::span<T>(values));
  }
  template <typename T>
  void read(std::vector<T>& values) {
    values.resize(read_count(min_size<T>()));
    if (!values.empty()) read_all(std::span<T>(values));
  }

  template <typename T>
  void read_all(std::span<T> values) {
    if constexpr (Number<T>) {
      align(sizeof(T));
      const std::span<const std::byte> bytes = take(values.size_bytes());
      std::memcpy(values.data(), bytes.data(), bytes.size());
      if (is_swapped_) swap_each(std::as_writable_bytes(values), sizeof(T));
    } else {
      for (T& value : values) read(value);
    }
  }

  std::size_t remaining() const { return bytes_.size() - position_; }
  std::size_t read_count(std::size_t bytes_each);
  void align(std::size_t size);  // alignment of cdr
  std::span<const std::byte> take(std::size_t size);
  static void swap_each(std::span<std::byte> bytes, std::size_t size);
  [[noreturn]] void fail(std::string_view reason) const;

  std::span<const std::byte> bytes_;
  Encoding encoding_;
  std::string place_;
  bool is_swapped_ = false;  // big-endian
  std::size_t position_ = 0;
};

// Parses a message. Ignores trailing bytes, as some middleware pads messages. Throws InputError for truncated or
// invalid bytes; place: "barn.mcap: /left, message 7".
template <Message T>
T read_message(std::span<const std::byte> bytes, Encoding encoding, std::string place) {
  T message;
  MessageReader reader(bytes, encoding, std::move(place));
  T::fields(message, reader);
  return message;
}

// Sums the smallest sizes of fields.
class MinSize {
 public:
  template <typename T>
  void operator()(std::string_view /*name*/, const T& /*value*/) {
    bytes_ += min_size<T>();
  }
  void ros1_only(const std::uint32_t& /*value*/) {}
  std::size_t bytes() const { return bytes_; }

 private:
  std::size_t bytes_ = 0;
};

template <typename T>
std::size_t min_size() {
  if constexpr (Number<T>) {
    return sizeof(T);
  } else if constexpr (Message<T>) {
    static const std::size_t bytes = [] {
      const T message;
      MinSize size;
      T::fields(message, size);
      return size.bytes();
    }();
    return bytes;
  } else if constexpr (requires { std::tuple_size<T>::value; }) {
    return std::tuple_size<T>::value * min_size<typename T::value_type>();
  } else {
    return sizeof(std::uint32_t);  // an empty string or sequence
  }
}

}  // namespace byre::ros
