#include "byre/io/image/grey_png.h"

#include <cstdint>
#include <random>
#include <utility>
#include <vector>

#include <gtest/gtest.h>
#include <libdeflate.h>
#include <opencv2/imgcodecs.hpp>

namespace byre {
namespace {

using Bytes = std::vector<std::uint8_t>;

// A smooth image with some noise, such that encoders choose various filters.
cv::Mat picture(int type, int width, int height) {
  cv::Mat made(height, width, type);
  std::mt19937 random(17);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const auto value = static_cast<unsigned>(3 * x + 2 * y * y / (1 + x) + random() % (1 + y % 23));
      if (type == CV_8U) made.at<std::uint8_t>(y, x) = static_cast<std::uint8_t>(value);
      if (type == CV_16U) made.at<std::uint16_t>(y, x) = static_cast<std::uint16_t>(97 * value);
    }
  }
  return made;
}

Bytes png_of(const cv::Mat& image, int strategy) {
  Bytes bytes;
  cv::imencode(".png", image, bytes, {cv::IMWRITE_PNG_COMPRESSION, 6, cv::IMWRITE_PNG_STRATEGY, strategy});
  return bytes;
}

// Values of one byte each, or of two, most significant byte first.
Bytes values_of(const cv::Mat& image) {
  if (image.type() == CV_8U) return {image.data, image.data + image.total()};
  Bytes values;
  for (auto value = image.begin<std::uint16_t>(); value != image.end<std::uint16_t>(); ++value) {
    values.push_back(static_cast<std::uint8_t>(*value >> 8U));
    values.push_back(static_cast<std::uint8_t>(*value));
  }
  return values;
}

class GreyPngOf : public testing::TestWithParam<std::pair<int, int>> {};  // type and strategy of OpenCV

TEST_P(GreyPngOf, DecodesTheWrittenValues) {
  const auto [type, strategy] = GetParam();
  for (const auto& [width, height] : {std::pair(1, 1), std::pair(1, 9), std::pair(131, 77)}) {
    const cv::Mat written = picture(type, width, height);
    const Bytes png = png_of(written, strategy);
    const auto read = decode_grey_png(*png_chunks(png));
    ASSERT_TRUE(read);
    EXPECT_EQ(read->width, width);
    EXPECT_EQ(read->height, height);
    EXPECT_EQ(read->values, values_of(written));
  }
}

INSTANTIATE_TEST_SUITE_P(Kinds, GreyPngOf,
                         testing::Values(std::pair<int, int>(CV_8U, cv::IMWRITE_PNG_STRATEGY_DEFAULT),
                                         std::pair<int, int>(CV_8U, cv::IMWRITE_PNG_STRATEGY_FILTERED),
                                         std::pair<int, int>(CV_16U, cv::IMWRITE_PNG_STRATEGY_FILTERED)));

TEST(GreyPng, IgnoresOtherKindsOfPng) {
  const Bytes colours = png_of(cv::Mat(8, 9, CV_8UC3, cv::Scalar(1, 2, 3)), cv::IMWRITE_PNG_STRATEGY_DEFAULT);
  EXPECT_FALSE(decode_grey_png(*png_chunks(colours)));
  Bytes one_bit;
  cv::imencode(".png", picture(CV_8U, 8, 9) > 40, one_bit, {cv::IMWRITE_PNG_BILEVEL, 1});
  EXPECT_FALSE(decode_grey_png(*png_chunks(one_bit)));
}

TEST(GreyPng, RejectsDamagedFiles) {
  const Bytes whole = png_of(picture(CV_8U, 40, 30), cv::IMWRITE_PNG_STRATEGY_FILTERED);
  auto without_pixels = *png_chunks(whole);
  std::erase_if(without_pixels, [](const PngChunk& chunk) { return chunk.type() == "IDAT"; });
  EXPECT_FALSE(decode_grey_png(without_pixels));
  // A header with one row too many, and the correct checksum.
  Bytes too_tall = whole;
  constexpr std::size_t kType = 12, kLowestOfHeight = 23, kChecksum = 29;
  ++too_tall[kLowestOfHeight];
  const std::uint32_t checksum = libdeflate_crc32(0, too_tall.data() + kType, kChecksum - kType);
  for (std::size_t i = 0; i < 4; ++i) too_tall[kChecksum + i] = static_cast<std::uint8_t>(checksum >> (24U - 8U * i));
  const auto chunks = png_chunks(too_tall);
  ASSERT_TRUE(chunks);
  EXPECT_FALSE(decode_grey_png(*chunks));
}

}  // namespace
}  // namespace byre
