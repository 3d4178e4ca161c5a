#include "byre/map/packed_steps.h"

#include "byre/input_error.h"

#include <algorithm>
#include <functional>
#include <random>

#include <gmock/gmock.h>

namespace byre {
namespace {

constexpr std::size_t kWhole = sizeof(PatchSteps);

// step_of(row, column)
PatchSteps steps_by(const std::function<int(int, int)>& step_of) {
  PatchSteps steps{};
  for (int row = 0; row < Patch::kSize; ++row) {
    for (int column = 0; column < Patch::kSize; column += 2) {
      steps[static_cast<std::size_t>(row * Patch::kSize + column) / 2] =
          static_cast<std::uint8_t>(step_of(row, column) | step_of(row, column + 1) << 4);
    }
  }
  return steps;
}

PatchSteps noise(int amplitude, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_int_distribution<int> any(0, amplitude);
  return steps_by([&](int, int) { return any(random); });
}

std::vector<std::byte> packed(const PatchSteps& steps) {
  ByteWriter writer;
  write_packed_steps(steps, writer);
  return writer.bytes();
}

PatchSteps unpacked_from(const std::vector<std::byte>& bytes) {
  ByteReader reader(bytes, "file", 0);
  const PatchSteps steps = read_packed_steps(reader);
  reader.require_end();
  return steps;
}

void expect_to_be_skipped(const std::vector<std::byte>& bytes) {
  ByteReader reader(bytes, "file", 0);
  skip_packed_steps(reader);
  reader.require_end();
}

TEST(PackedSteps, ReadBackEveryPatch) {
  for (const int amplitude : {0, 1, 2, 3, 5, 8, 15}) {
    for (unsigned seed = 0; seed < 20; ++seed) {
      const PatchSteps steps = noise(amplitude, seed);
      EXPECT_EQ(unpacked_from(packed(steps)), steps) << amplitude;
      EXPECT_LE(packed(steps).size(), kWhole + 1);
      expect_to_be_skipped(packed(steps));
    }
  }
}

TEST(PackedSteps, UseOneBitForAPredictedPixel) {
  EXPECT_EQ(packed(steps_by([](int, int) { return 8; })).size(), 2u + 256 / 8);
  const auto is_edge = [](int, int column) { return column < 7 ? 8 : 15; };
  EXPECT_EQ(packed(steps_by(is_edge)).size(), 2u + (256 + 14 + 7) / 8);  // an edge adds 14 bits where it begins
}

TEST(PackedSteps, AreStoredUncompressedIfShorter) {
  EXPECT_EQ(packed(noise(15, 1)).size(), kWhole + 1);
}

// A patch of one bit per pixel, with that many zero low-bit planes.
std::vector<std::byte> flat_by(std::size_t planes) {
  std::vector<std::byte> bytes(2 + 32 * planes, std::byte{0});
  bytes.resize(bytes.size() + 32, std::byte{0xff});
  bytes[0] = static_cast<std::byte>(bytes.size() - 1);
  bytes[1] = static_cast<std::byte>(planes);
  return bytes;
}

TEST(PackedSteps, AreRejectedIfNotCanonical) {
  EXPECT_NO_THROW(unpacked_from(flat_by(0)));
  EXPECT_THROW(unpacked_from(flat_by(1)), InputError);  // a useless plane
  EXPECT_THROW(unpacked_from(flat_by(2)), InputError);
  EXPECT_THROW(unpacked_from(flat_by(3)), InputError);  // more planes than allowed
  std::vector<std::byte> whole(kWhole + 1, std::byte{0});
  whole[0] = static_cast<std::byte>(kWhole);
  EXPECT_THROW(unpacked_from(whole), InputError);  // steps that compress
  std::vector<std::byte> bytes = flat_by(0);
  bytes.front() = static_cast<std::byte>(bytes.size());
  bytes.push_back(std::byte{0});
  EXPECT_THROW(unpacked_from(bytes), InputError);  // an extra byte
  bytes.back() = std::byte{1};
  EXPECT_THROW(unpacked_from(bytes), InputError);  // an extra pixel
}

TEST(PackedSteps, AreRejectedIfInvalid) {
  std::vector<std::byte> bytes = flat_by(0);
  bytes.pop_back();
  EXPECT_THROW(unpacked_from(bytes), InputError);  // fewer bytes than announced
  bytes.front() = static_cast<std::byte>(bytes.size() - 1);
  EXPECT_THROW(unpacked_from(bytes), InputError);  // too few pixels
  bytes = flat_by(1);
  bytes.resize(33);
  bytes.front() = static_cast<std::byte>(bytes.size() - 1);
  EXPECT_THROW(unpacked_from(bytes), InputError);  // a plane without high bits
  bytes.resize(20);
  bytes.front() = static_cast<std::byte>(bytes.size() - 1);
  EXPECT_THROW(unpacked_from(bytes), InputError);  // an incomplete plane
  EXPECT_THROW(unpacked_from({std::byte{0}}), InputError);
  EXPECT_THROW(unpacked_from(std::vector<std::byte>(201, std::byte{200})), InputError);
  bytes = flat_by(0);
  bytes[2] = bytes[3] = std::byte{0};
  bytes.push_back(std::byte{0xff});
  bytes.push_back(std::byte{0xff});
  bytes.front() = static_cast<std::byte>(bytes.size() - 1);
  EXPECT_THROW(unpacked_from(bytes), InputError);  // sixteen zeros
}

}  // namespace
}  // namespace byre
