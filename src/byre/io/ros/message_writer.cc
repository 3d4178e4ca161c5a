#include "byre/io/ros/message_writer.h"

namespace byre::ros {
namespace {

constexpr std::array kLittleEndianCdr = {std::byte{0}, std::byte{1}, std::byte{0}, std::byte{0}};

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

}  // namespace byre::ros
