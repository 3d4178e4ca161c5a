#include "byre/input/byte_stream.h"

#include "byre/input_error.h"

#include <xxhash.h>

namespace byre {

std::uint64_t checksum(std::span<const std::byte> bytes) {
  return XXH3_64bits(bytes.data(), bytes.size());
}

void ByteWriter::write_bytes(std::span<const std::byte> bytes) {
  if (bytes.empty()) return;
  const std::size_t begin = bytes_.size();
  bytes_.resize(begin + bytes.size());
  std::memcpy(bytes_.data() + begin, bytes.data(), bytes.size());
}

void ByteWriter::write_text(std::string_view text) {
  write(static_cast<std::uint32_t>(text.size()));
  write_all(std::span(text));
}

std::span<const std::byte> ByteReader::take(std::size_t size) {
  if (size > remaining()) {
    fail("ends too early: " + std::to_string(size) + " more bytes are needed, " + std::to_string(remaining()) +
         " are left");
  }
  position_ += size;
  return bytes_.subspan(position_ - size, size);
}

std::string ByteReader::read_text() {
  std::string text(read_count(1), '\0');
  read_all(std::span(text));
  return text;
}

std::uint32_t ByteReader::read_count(std::size_t bytes_each) {
  const auto count = read<std::uint32_t>();
  if (count > remaining() / bytes_each) {
    fail("claims " + std::to_string(count) + " entries, more than the " + std::to_string(remaining()) +
         " remaining bytes can hold");
  }
  return count;
}

void ByteReader::require_end() const {
  if (remaining() > 0) fail(std::to_string(remaining()) + " bytes are left over");
}

void ByteReader::fail(std::string_view reason) const {
  throw InputError(place_ + " at byte " + std::to_string(first_byte_ + position_), reason,
                   "the file is damaged; use a copy, or make it again");
}

}  // namespace byre
