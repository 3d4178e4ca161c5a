#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

namespace byre {

// Binary files of byre are little-endian, as are the machines it runs on; numbers are copied as they lie in memory.
static_assert(std::endian::native == std::endian::little, "byre's binary files are little-endian");

template <typename T>
concept PlainNumber = std::is_arithmetic_v<T> || std::is_enum_v<T>;

// XXH3 (64 bits) of the bytes: tells damage, not malice.
std::uint64_t checksum(std::span<const std::byte> bytes);
// The same of several pieces, as if they lay one behind the other.
std::uint64_t checksum_of_pieces(std::span<const std::span<const std::byte>> pieces);
// The same of so many bytes, which read_at gives piece by piece, from a place among them on.
using ReadAt = std::function<void(std::size_t offset, std::span<std::byte> bytes)>;
std::uint64_t checksum_of_file(const ReadAt& read_at, std::size_t offset, std::size_t size);

// Appends numbers to a growing piece of a file.
class ByteWriter {
 public:
  template <PlainNumber T>
  void write(T value) {
    write_bytes(std::as_bytes(std::span(&value, 1)));
  }
  template <PlainNumber T>
  void write_all(std::span<const T> values) {
    write_bytes(std::as_bytes(values));
  }
  void write_bytes(std::span<const std::byte> bytes);
  void write_text(std::string_view text);  // length of the text (u32), then its bytes
  // The lowest bytes of a number. Precondition: 1 to 8 bytes, and nothing in the others.
  void write_low_bytes(std::uint64_t value, std::size_t count);
  // Seven bits a byte, the lowest first; all bytes but the last have their highest bit set.
  void write_varint(std::uint32_t value);

  std::size_t size() const { return bytes_.size(); }
  const std::vector<std::byte>& bytes() const { return bytes_; }

 private:
  std::vector<std::byte> bytes_;
};

// Takes numbers from a piece of a file and never reads beyond it. Borrows the bytes. Every failure is an InputError
// whose place is "PLACE at byte N", N counted from the file's start.
class ByteReader {
 public:
  // place: "barn.byre: section points"; first_byte: where the bytes begin in the file.
  ByteReader(std::span<const std::byte> bytes, std::string place, std::size_t first_byte)
      : bytes_(bytes), place_(std::move(place)), first_byte_(first_byte) {}

  template <PlainNumber T>
  T read() {
    T value;
    std::memcpy(&value, take(sizeof(T)).data(), sizeof(T));
    return value;
  }
  template <PlainNumber T>
  void read_all(std::span<T> values) {
    const std::span<const std::byte> bytes = take(values.size_bytes());
    if (!bytes.empty()) std::memcpy(values.data(), bytes.data(), bytes.size());
  }
  std::span<const std::byte> take(std::size_t size) {
    if (size > remaining()) fail_to_take(size);
    position_ += size;
    return bytes_.subspan(position_ - size, size);
  }
  std::span<const std::byte> rest() const { return bytes_.subspan(position_); }  // what is left, not taken
  std::string read_text();                           // text as ByteWriter::write_text wrote it
  std::uint64_t read_low_bytes(std::size_t count) {  // precondition: 1 to 8
    std::uint64_t value = 0;
    const std::size_t bits_above = 8 * (sizeof(value) - count);
    if (remaining() < sizeof(value)) return read_last_bytes(count);
    std::memcpy(&value, bytes_.data() + position_, sizeof(value));
    position_ += count;
    return value << bits_above >> bits_above;
  }
  std::uint32_t read_varint();  // refuses what takes more bytes than it needs
  void skip_varint();           // whatever it is

  // A number (u32) of things that take at least bytes_each each: refuses more than the remaining bytes can hold, so
  // that nothing is reserved that the file does not justify. Precondition: bytes_each > 0.
  std::uint32_t read_count(std::size_t bytes_each);

  std::size_t remaining() const { return bytes_.size() - position_; }
  void require_end() const;  // fails when bytes are left over
  [[noreturn]] void fail(std::string_view reason) const;

 private:
  [[noreturn]] void fail_to_take(std::size_t size) const;
  std::uint64_t read_last_bytes(std::size_t count);  // as read_low_bytes, where fewer than 8 are left

  std::span<const std::byte> bytes_;
  std::string place_;
  std::size_t first_byte_;
  std::size_t position_ = 0;
};

}  // namespace byre
