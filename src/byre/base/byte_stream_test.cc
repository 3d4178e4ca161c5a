#include "byre/base/byte_stream.h"

#include "byre/input_error.h"

#include <array>

#include <gmock/gmock.h>

namespace byre {
namespace {

ByteReader reader_of(const ByteWriter& writer) {
  return {writer.bytes(), "file: section test", 100};
}

TEST(ByteStream, ReadsBackWhatWasWritten) {
  ByteWriter writer;
  writer.write(std::uint16_t{7});
  writer.write(-1.5);
  writer.write_all(std::span<const float>(std::array{1.0f, 2.0f}));
  writer.write_text("barn");

  ByteReader reader = reader_of(writer);
  EXPECT_EQ(reader.read<std::uint16_t>(), 7);
  EXPECT_EQ(reader.read<double>(), -1.5);
  std::array<float, 2> floats{};
  reader.read_all(std::span<float>(floats));
  EXPECT_THAT(floats, testing::ElementsAre(1.0f, 2.0f));
  EXPECT_EQ(reader.read_text(), "barn");
  EXPECT_NO_THROW(reader.require_end());
}

TEST(ByteStream, UsesLittleEndianOrder) {
  ByteWriter writer;
  writer.write(std::uint32_t{0x01020304});
  EXPECT_THAT(writer.bytes(), testing::ElementsAre(std::byte{4}, std::byte{3}, std::byte{2}, std::byte{1}));
}

TEST(ByteStream, ReadsBackShortNumbers) {
  for (const std::uint32_t number : {0u, 1u, 127u, 128u, 16383u, 16384u, 0xffffffffu}) {
    ByteWriter writer;
    writer.write_varint(number);
    EXPECT_EQ(writer.size(), number < 128 ? 1u : number < 16384 ? 2u : number < 1u << 21 ? 3u : 5u);
    EXPECT_EQ(reader_of(writer).read_varint(), number);
    ByteReader skipping = reader_of(writer);
    skipping.skip_varint();
    EXPECT_NO_THROW(skipping.require_end());
  }
  ByteWriter writer;
  writer.write_low_bytes(0x010203, 3);
  EXPECT_THAT(writer.bytes(), testing::ElementsAre(std::byte{3}, std::byte{2}, std::byte{1}));
  EXPECT_EQ(reader_of(writer).read_low_bytes(3), 0x010203u);
}

TEST(ByteStream, RejectsNumbersThatAreNotInShortestForm) {
  const auto refuses = [](std::initializer_list<std::uint8_t> bytes) {
    ByteWriter writer;
    writer.write_all(std::span<const std::uint8_t>(bytes));
    EXPECT_THROW(reader_of(writer).read_varint(), InputError);
  };
  refuses({0x80, 0x00});
  refuses({0xff, 0xff, 0xff, 0xff, 0x1f});
  refuses({0x80, 0x80, 0x80, 0x80, 0x80, 0x01});
}

TEST(ByteStream, ReportsThePositionOfATruncation) {
  ByteWriter writer;
  writer.write(std::uint32_t{1});
  ByteReader reader = reader_of(writer);
  reader.read<std::uint16_t>();
  try {
    reader.read<std::uint64_t>();
    FAIL() << "read beyond the end";
  } catch (const InputError& error) {
    EXPECT_EQ(error.place(), "file: section test at byte 102");
  }
}

TEST(ByteStream, RejectsCountsBeyondTheRemainingBytes) {
  ByteWriter writer;
  writer.write(std::uint32_t{3});
  writer.write(std::uint64_t{0});
  EXPECT_EQ(reader_of(writer).read_count(2), 3u);
  EXPECT_THROW(reader_of(writer).read_count(4), InputError);
}

TEST(ByteStream, RejectsTextBeyondTheRemainingBytes) {
  ByteWriter writer;
  writer.write(std::uint32_t{1000000});
  EXPECT_THROW(reader_of(writer).read_text(), InputError);
}

TEST(ByteStream, RejectsTrailingBytes) {
  ByteWriter writer;
  writer.write(std::uint8_t{1});
  EXPECT_THROW(reader_of(writer).require_end(), InputError);
}

TEST(Checksum, ChangesWithEveryBit) {
  EXPECT_NE(checksum(std::as_bytes(std::span("byre"))), checksum(std::as_bytes(std::span("byrd"))));
}

}  // namespace
}  // namespace byre
