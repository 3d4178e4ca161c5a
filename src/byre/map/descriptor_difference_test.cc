#include "byre/map/descriptor_difference.h"

#include "byre/input_error.h"

#include <algorithm>
#include <functional>
#include <random>

#include <gmock/gmock.h>

namespace byre {
namespace {

Descriptor random_descriptor(std::mt19937_64& random) {
  Descriptor descriptor;
  std::ranges::generate(descriptor, std::ref(random));
  return descriptor;
}

void flip(Descriptor& descriptor, std::size_t bit) {
  descriptor[bit / 64] ^= std::uint64_t{1} << (bit % 64);
}

Descriptor read_back(const std::vector<std::byte>& bytes, const Descriptor& from) {
  ByteReader reader(bytes, "file", 0);
  const Descriptor read = read_difference(reader, from);
  reader.require_end();
  return read;
}

TEST(DescriptorDifference, ReadsBackEveryDescriptor) {
  std::mt19937_64 random(1);
  for (const int flipped : {0, 1, 2, 10, 30, 60, 120, 256}) {
    const Descriptor from = random_descriptor(random);
    Descriptor descriptor = from;
    for (int i = 0; i < flipped; ++i) flip(descriptor, random() % 256);
    ByteWriter writer;
    write_difference(descriptor, from, writer);
    EXPECT_LE(writer.size(), sizeof(Descriptor) + 1);
    EXPECT_EQ(read_back(writer.bytes(), from), descriptor) << flipped;
  }
}

TEST(DescriptorDifference, UsesOneByteForEqualityAndHalfAByteForABit) {
  std::mt19937_64 random(2);
  const Descriptor from = random_descriptor(random);
  ByteWriter writer;
  write_difference(from, from, writer);
  EXPECT_EQ(writer.size(), 1u);
  Descriptor descriptor = from;
  for (const std::size_t bit : {3u, 4u, 250u, 255u}) flip(descriptor, bit);
  ByteWriter other;
  write_difference(descriptor, from, other);
  EXPECT_EQ(other.size(), 1u + (4 + 245 / 15 + 1) / 2);
  EXPECT_EQ(read_back(other.bytes(), from), descriptor);
}

TEST(DescriptorDifference, IsRejectedIfNotCanonical) {
  const Descriptor from{};
  const auto bytes = [](std::initializer_list<int> values) {
    std::vector<std::byte> result;
    for (const int value : values) result.push_back(static_cast<std::byte>(value));
    return result;
  };
  EXPECT_THROW(read_back(bytes({1, 0x10}), from), InputError);  // a non-zero unused half byte
  std::vector<std::byte> beyond = bytes({1});
  beyond.resize(20, std::byte{0xff});
  EXPECT_THROW(read_back(beyond, from), InputError);
  std::vector<std::byte> whole = bytes({255});
  whole.resize(33, std::byte{0});
  EXPECT_THROW(read_back(whole, from), InputError);  // a descriptor with a shorter code
}

}  // namespace
}  // namespace byre
