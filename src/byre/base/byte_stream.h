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

// Binary files of byre are little-endian, as are all supported machines; numbers are copied without conversion.
static_assert(std::endian::native == std::endian::little, "byre's binary files are little-endian");

template <typename T>
concept PlainNumber = std::is_arithmetic_v<T> || std::is_enum_v<T>;

// XXH3 (64 bits) of the bytes: detects damage, not manipulation.
std::uint64_t checksum(std::span<const std::byte> bytes);
// Same, of several pieces as if they were concatenated.
std::uint64_t checksum_of_pieces(std::span<const std::span<const std::byte>> pieces);
// Same, of `size` bytes beginning at `offset`, which read_at delivers piece by piece.
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
  // Writes the `count` lowest bytes of a number. Precondition: 1 to 8 bytes, the others are zero.
  void write_low_bytes(std::uint64_t value, std::size_t count);
  // Writes seven bits per byte, the lowest first; all bytes but the last have their highest bit set.
  void write_varint(std::uint32_t value);

  std::size_t size() const { return bytes_.size(); }
  const std::vector<std::byte>& bytes() const { return bytes_; }

 private:
  std::vector<std::byte> bytes_;
};

// Reads numbers from a piece of a file, never beyond its end. Borrows the bytes. Each failure is an InputError with the
// place "PLACE at byte N"; N counts from the start of the file.
class ByteReader {
 public:
  // place: "barn.byre: section points"; first_byte: offset of the bytes in the file.
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
  std::span<const std::byte> rest() const { return bytes_.subspan(position_); }  // the remaining bytes, not consumed
  std::string read_text();                           // text written by ByteWriter::write_text
  std::uint64_t read_low_bytes(std::size_t count) {  // precondition: 1 to 8
    std::uint64_t value = 0;
    const std::size_t bits_above = 8 * (sizeof(value) - count);
    if (remaining() < sizeof(value)) return read_last_bytes(count);
    std::memcpy(&value, bytes_.data() + position_, sizeof(value));
    position_ += count;
    return value << bits_above >> bits_above;
  }
  std::uint32_t read_varint();  // rejects encodings longer than necessary
  void skip_varint();           // without checks

  // Reads a count (u32) of items of at least bytes_each bytes. Rejects counts that exceed the remaining bytes, so that
  // allocations are bounded by the file. Precondition: bytes_each > 0.
  std::uint32_t read_count(std::size_t bytes_each);

  std::size_t remaining() const { return bytes_.size() - position_; }
  void require_end() const;  // fails if bytes are left over
  [[noreturn]] void fail(std::string_view reason) const;

 private:
  [[noreturn]] void fail_to_take(std::size_t size) const;
  std::uint64_t read_last_bytes(std::size_t count);  // read_low_bytes for fewer than 8 remaining bytes

  std::span<const std::byte> bytes_;
  std::string place_;
  std::size_t first_byte_;
  std::size_t position_ = 0;
};

}  // namespace byre
