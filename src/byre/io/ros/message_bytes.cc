#include "byre/io/ros/message_bytes.h"

#include "byre/input_error.h"

#include <algorithm>
#include <bit>

namespace byre::ros {
namespace {

constexpr std::array kLittleEndianCdr = {std::byte{0}, std::byte{1}, std::byte{0}, std::byte{0}};

static_assert(std::endian::native == std::endian::little, "messages are copied as they lie in memory");

constexpr std::size_t kEncapsulation = 4;  // bytes before the fields: representation (2), options (2)

}  // namespace

MessageWriter::MessageWriter(Encoding encoding) : encoding_(encoding) {
  if (encoding == Encoding::cdr) writer_.write_bytes(kLittleEndianCdr);
}

void MessageWriter::write(const std::string& text) {
  const std::size_t size = text.size() + (encoding_ == Encoding::cdr ? 1 : 0);  // with the terminating zero
  write(static_cast<std::uint32_t>(size));
  writer_.write_all(std::span(text.c_str(), size));
}

void MessageWriter::align(std::size_t size) {
  if (encoding_ == Encoding::ros1) return;
  while ((writer_.size() - kLittleEndianCdr.size()) % size > 0) writer_.write(std::uint8_t{0});
}

MessageReader::MessageReader(std::span<const std::byte> bytes, Encoding encoding, std::string place)
    : bytes_(bytes), encoding_(encoding), place_(std::move(place)) {
  if (encoding_ == Encoding::ros1) return;
  const std::span<const std::byte> encapsulation = take(kEncapsulation);
  const int representation = std::to_integer<int>(encapsulation[0]) << 8 | std::to_integer<int>(encapsulation[1]);
  if (representation > 1)
    fail("is in representation " + std::to_string(representation) + " of CDR, but plain CDR is required");
  is_swapped_ = representation == 0;
}

void MessageReader::read(bool& value) {
  value = take(1)[0] != std::byte{0};
}

void MessageReader::read(std::string& text) {
  const std::span<const std::byte> bytes = take(read_count(1));
  text.assign(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  if (encoding_ == Encoding::cdr && !text.empty() && text.back() == '\0') text.pop_back();
}

std::size_t MessageReader::read_count(std::size_t bytes_each) {
  std::uint32_t count = 0;
  read(count);
  if (count > remaining() / bytes_each) {
    fail("claims " + std::to_string(count) + " entries, more than the " + std::to_string(remaining()) +
         " remaining bytes can hold");
  }
  return count;
}

void MessageReader::align(std::size_t size) {
  if (encoding_ == Encoding::ros1) return;
  const std::size_t behind = (position_ - kEncapsulation) % size;
  if (behind > 0) take(size - behind);
}

std::span<const std::byte> MessageReader::take(std::size_t size) {
  if (size > remaining()) {
    fail("ends too early: " + std::to_string(size) + " more bytes are needed, " + std::to_string(remaining()) +
         " are left");
  }
  position_ += size;
  return bytes_.subspan(position_ - size, size);
}

void MessageReader::swap_each(std::span<std::byte> bytes, std::size_t size) {
  for (; !bytes.empty(); bytes = bytes.subspan(size)) std::ranges::reverse(bytes.first(size));
}

void MessageReader::fail(std::string_view reason) const {
  throw InputError(place_ + " at byte " + std::to_string(position_), reason,
                   "the message is damaged, or its type differs from the declared one");
}

}  // namespace byre::ros
