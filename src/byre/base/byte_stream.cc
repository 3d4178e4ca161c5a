#include "byre/base/byte_stream.h"

#include "byre/input_error.h"

#include <algorithm>
#include <cassert>
#include <limits>
#include <memory>
#include <new>

#include <xxhash.h>

namespace byre {
namespace {

constexpr int kVarintBits = 7;
constexpr std::uint8_t kVarintContinues = 1u << kVarintBits;

class GrowingChecksum {
 public:
  GrowingChecksum() : state_(XXH3_createState(), &XXH3_freeState) {
    if (!state_) throw std::bad_alloc();
    XXH3_64bits_reset(state_.get());
  }

  void add(std::span<const std::byte> bytes) { XXH3_64bits_update(state_.get(), bytes.data(), bytes.size()); }
  std::uint64_t value() const { return XXH3_64bits_digest(state_.get()); }

 private:
  std::unique_ptr<XXH3_state_t, decltype(&XXH3_freeState)> state_;
};

}  // namespace

std::uint64_t checksum(std::span<const std::byte> bytes) {
  return XXH3_64bits(bytes.data(), bytes.size());
}

std::uint64_t checksum_of_pieces(std::span<const std::span<const std::byte>> pieces) {
  GrowingChecksum sum;
  for (const std::span<const std::byte> piece : pieces) sum.add(piece);
  return sum.value();
}

std::uint64_t checksum_of_file(const ReadAt& read_at, std::size_t offset, std::size_t size) {
  constexpr std::size_t kPiece = 1 << 18;  // bytes
  std::vector<std::byte> memory(std::min(size, kPiece));
  GrowingChecksum sum;
  for (std::size_t begin = 0; begin < size; begin += kPiece) {
    const std::span<std::byte> piece = std::span(memory).first(std::min(kPiece, size - begin));
    read_at(offset + begin, piece);
    sum.add(piece);
  }
  return sum.value();
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

void ByteWriter::write_low_bytes(std::uint64_t value, std::size_t count) {
  assert(count >= 1 && count <= sizeof(value) && (count == sizeof(value) || value >> (8 * count) == 0));
  write_bytes(std::as_bytes(std::span(&value, 1)).first(count));
}

void ByteWriter::write_varint(std::uint32_t value) {
  for (; value >= kVarintContinues; value >>= kVarintBits) {
    write(static_cast<std::uint8_t>(value | kVarintContinues));
  }
  write(static_cast<std::uint8_t>(value));
}

void ByteReader::fail_to_take(std::size_t size) const {
  fail("ends too early: " + std::to_string(size) + " more bytes are needed, " + std::to_string(remaining()) +
       " are left");
}

std::string ByteReader::read_text() {
  std::string text(read_count(1), '\0');
  read_all(std::span(text));
  return text;
}

std::uint64_t ByteReader::read_last_bytes(std::size_t count) {
  assert(count >= 1 && count <= sizeof(std::uint64_t));
  std::uint64_t value = 0;
  std::memcpy(&value, take(count).data(), count);
  return value;
}

void ByteReader::skip_varint() {
  while ((read<std::uint8_t>() & kVarintContinues) != 0) {
  }
}

std::uint32_t ByteReader::read_varint() {
  std::uint64_t value = 0;
  for (int shift = 0; shift < 32; shift += kVarintBits) {
    const auto byte = read<std::uint8_t>();
    value |= static_cast<std::uint64_t>(byte & (kVarintContinues - 1)) << shift;
    if ((byte & kVarintContinues) != 0) continue;
    const bool is_shortest = byte != 0 || shift == 0;
    if (!is_shortest || value > std::numeric_limits<std::uint32_t>::max()) break;
    return static_cast<std::uint32_t>(value);
  }
  fail("has a number with an invalid encoding");
}

std::uint32_t ByteReader::read_count(std::size_t bytes_each) {
  const auto count = read<std::uint32_t>();
  if (count > remaining() / bytes_each) {
    fail("declares " + std::to_string(count) + " entries, more than the " + std::to_string(remaining()) +
         " remaining bytes can hold");
  }
  return count;
}

void ByteReader::require_end() const {
  if (remaining() > 0) fail(std::to_string(remaining()) + " bytes are left over");
}

void ByteReader::fail(std::string_view reason) const {
  throw InputError(place_ + " at byte " + std::to_string(first_byte_ + position_), reason,
                   "the file is damaged; use a copy, or create it again");
}

}  // namespace byre
