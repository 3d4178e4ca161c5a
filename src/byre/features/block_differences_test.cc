#include "byre/features/block_differences.h"

#include <cstdlib>
#include <random>
#include <vector>

#include <gmock/gmock.h>

namespace byre {
namespace {

constexpr int kStride = 40;

std::vector<std::uint8_t> noise(std::uint32_t seed) {
  std::mt19937 random(seed);
  std::vector<std::uint8_t> image(static_cast<std::size_t>(kStride) * kBlockRows);
  for (std::uint8_t& grey : image) grey = static_cast<std::uint8_t>(random());
  return image;
}

int reference_differences(const std::uint8_t* block, const std::uint8_t* candidate) {
  int sum = 0;
  for (int row = 0; row < kBlockRows; ++row) {
    for (int column = 0; column < kBlockColumns; ++column) {
      sum += std::abs(int(block[row * kStride + column]) - int(candidate[row * kStride + column]));
    }
  }
  return sum;
}

TEST(BlockDifferences, MatchEachCandidate) {
  const std::vector<std::uint8_t> first = noise(1);
  const std::vector<std::uint8_t> second = noise(2);
  const auto sums = block_differences(first.data() + 5, kStride, second.data() + 3, kStride);
  for (int i = 0; i < kBlockCandidates; ++i) {
    EXPECT_EQ(sums[static_cast<std::size_t>(i)], reference_differences(first.data() + 5, second.data() + 3 + i)) << i;
  }
}

TEST(BlockDifferences, DoNotOverflowForBlackAndWhite) {
  const std::vector<std::uint8_t> black(static_cast<std::size_t>(kStride) * kBlockRows, 0);
  const std::vector<std::uint8_t> white(black.size(), 255);
  EXPECT_THAT(block_differences(black.data(), kStride, white.data(), kStride),
              ::testing::Each(255 * kBlockRows * kBlockColumns));
}

}  // namespace
}  // namespace byre
