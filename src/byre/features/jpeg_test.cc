#include "byre/features/jpeg.h"

#include <cmath>
#include <cstdint>
#include <random>

#include <gtest/gtest.h>

namespace byre {
namespace {

constexpr std::size_t kAnySize = 1 << 20;  // bytes

Image smooth_image(int width, int height) {
  Image image{width, height, {}};
  for (int row = 0; row < height; ++row) {
    for (int column = 0; column < width; ++column) {
      image.pixels.push_back(static_cast<std::uint8_t>(std::lround(128 + 90 * std::sin(0.05 * column + 0.03 * row))));
    }
  }
  return image;
}

Image noise(int width, int height) {
  std::mt19937 random(1);
  Image image{width, height, {}};
  for (int i = 0; i < width * height; ++i) image.pixels.push_back(static_cast<std::uint8_t>(random() >> 24U));
  return image;
}

double mean_difference(const Image& one, const Image& other) {
  double sum = 0.0;
  for (std::size_t i = 0; i < one.pixels.size(); ++i) sum += std::abs(one.pixels[i] - other.pixels[i]);
  return sum / static_cast<double>(one.pixels.size());
}

TEST(Jpeg, KeepsSmoothImagesOfOddSizes) {
  for (const auto& [width, height] : {std::pair(363, 231), std::pair(1, 1), std::pair(17, 9), std::pair(1024, 3)}) {
    const Image image = smooth_image(width, height);
    const std::optional<Image> decoded = decode_jpeg(encode_jpeg(image, kAnySize));
    ASSERT_TRUE(decoded) << width;
    EXPECT_EQ(decoded->width, width);
    EXPECT_EQ(decoded->height, height);
    EXPECT_LT(mean_difference(*decoded, image), 2.0) << width;
  }
}

TEST(Jpeg, LowersTheQualityToKeepTheSize) {
  const Image image = noise(200, 100);
  const std::vector<std::byte> full = encode_jpeg(image, kAnySize);
  const std::size_t limit = full.size() / 2;
  const std::vector<std::byte> reduced = encode_jpeg(image, limit);
  ASSERT_FALSE(reduced.empty());
  EXPECT_LE(reduced.size(), limit);
  const std::optional<Image> decoded = decode_jpeg(reduced);
  ASSERT_TRUE(decoded);
  EXPECT_LT(mean_difference(*decode_jpeg(full), image), mean_difference(*decoded, image));
  EXPECT_TRUE(encode_jpeg(image, 100).empty());
}

TEST(Jpeg, EncodesEqualImagesEqually) {
  EXPECT_EQ(encode_jpeg(noise(64, 48), kAnySize), encode_jpeg(noise(64, 48), kAnySize));
}

TEST(Jpeg, RefusesEmptyImages) {
  EXPECT_TRUE(encode_jpeg({}, kAnySize).empty());
  EXPECT_TRUE(encode_jpeg({0, 5, {}}, kAnySize).empty());
}

TEST(Jpeg, RefusesDamagedAndLargeFiles) {
  const std::vector<std::byte> jpeg = encode_jpeg(smooth_image(363, 231), kAnySize);
  EXPECT_FALSE(decode_jpeg({}));
  EXPECT_FALSE(decode_jpeg(std::span(jpeg).first(jpeg.size() / 2)));
  EXPECT_FALSE(decode_jpeg(std::span(jpeg).subspan(1)));
  EXPECT_FALSE(decode_jpeg(encode_jpeg(smooth_image(1025, 2), kAnySize)));
}

}  // namespace
}  // namespace byre
