#pragma once

#include "byre/base/byte_stream.h"
#include "byre/io/ros/message.h"

#include <array>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace byre::ros {

// Serialises the fields of a message, little-endian.
class MessageWriter {
 public:
  explicit MessageWriter(Encoding encoding);

  template <typename T>
  void operator()(std::string_view /*name*/, const T& value) {
    write(value);
  }
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

}  // namespace byre::ros
