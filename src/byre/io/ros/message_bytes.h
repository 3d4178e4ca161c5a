#pragma once

#include "byre/base/byte_stream.h"

#include <array>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

namespace byre::ros {

// Struct of messages.h or services.h with a list of fields.
template <typename T>
concept Message = requires(T& message, int& visit) {
  T::fields(message, visit);
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

// Serialises the fields of a message, little-endian.
class MessageWriter {
 public:
  explicit MessageWriter(Encoding encoding);

  void operator()(std::string_view /*names*/, const auto&... values) { (write(values), ...); }
  void ros1_only(std::uint32_t value) {
    if (encoding_ == Encoding::ros1) write(value);
  }
  const std::vector<std::byte>& bytes() const { return writer_.bytes(); }

 private:
  template <Number T>
  void write(const T& value) {
    write_all(std::span(&value, 1));
  }
  void write(const std::string& text);
  template <Message T>
  void write(const T& message) {
    T::fields(message, *this);
  }
  template <typename T, std::size_t n>
  void write(const std::array<T, n>& values) {
    write_all(std::span<const T>(values));
  }
  template <typename T>
  void write(const std::vector<T>& values) {
    write(static_cast<std::uint32_t>(values.size()));
    if (!values.empty()) write_all(std::span<const T>(values));
  }

  template <typename T>
  void write_all(std::span<const T> values) {
    if constexpr (Number<T>) {
      align(sizeof(T));
      writer_.write_bytes(std::as_bytes(values));
    } else {
      for (const T& value : values) write(value);
    }
  }

  void align(std::size_t size);  // alignment of cdr

  Encoding encoding_;
  ByteWriter writer_;
};

template <Message T>
std::vector<std::byte> write_message(const T& message, Encoding encoding) {
  MessageWriter writer(encoding);
  T::fields(message, writer);
  return writer.bytes();
}

// Smallest size of a value in either encoding.
template <typename T>
std::size_t min_size();

// Parses the fields of a message within bounds; allocates no more than the remaining bytes justify. Borrows the bytes.
// Throws InputError with the place "PLACE at byte N".
class MessageReader {
 public:
  // Throws InputError if cdr bytes lack the header of ROS 2.
  MessageReader(std::span<const std::byte> bytes, Encoding encoding, std::string place);

  void operator()(std::string_view /*names*/, auto&... values) { (read(values), ...); }
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
  template <typename... T>
  void operator()(std::string_view /*names*/, const T&... /*values*/) {
    bytes_ += (min_size<T>() + ...);
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
