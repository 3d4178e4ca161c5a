#include "byre/io/recording/bag_image.h"

#include "byre/io/ros/message_matchers.h"
#include <gmock/gmock.h>

namespace byre {
namespace {

using testing::Each;
using testing::ElementsAre;
using testing::HasSubstr;

ros::Image image(const std::string& encoding, std::uint32_t width, std::uint32_t height, std::vector<std::uint8_t> data,
                 std::uint32_t step) {
  return {{}, height, width, encoding, 0, step, std::move(data)};
}

std::vector<std::uint8_t> pixels_of(const ros::Image& message) {
  const ImageReading<Image> read = grey_of(message);
  EXPECT_TRUE(read.image.has_value()) << message.encoding << " " << read.failure;
  return read.image ? read.image->pixels : std::vector<std::uint8_t>();
}

TEST(BagImage, KeepsGreyPixelsWithoutRowPadding) {
  EXPECT_THAT(pixels_of(image("mono8", 2, 2, {1, 2, 99, 3, 4, 99}, 3)), ElementsAre(1, 2, 3, 4));
  EXPECT_THAT(pixels_of(image("8UC1", 2, 2, {1, 2, 99, 3, 4}, 3)), ElementsAre(1, 2, 3, 4));
}

TEST(BagImage, ConvertsColourToGrey) {
  // 0.299 red + 0.587 green + 0.114 blue.
  EXPECT_THAT(pixels_of(image("rgb8", 1, 1, {200, 100, 50}, 3)), ElementsAre(124));
  EXPECT_THAT(pixels_of(image("bgr8", 1, 1, {50, 100, 200}, 3)), ElementsAre(124));
  EXPECT_THAT(pixels_of(image("rgba8", 1, 1, {200, 100, 50, 7}, 4)), ElementsAre(124));
  EXPECT_THAT(pixels_of(image("bgra8", 1, 1, {50, 100, 200, 7}, 4)), ElementsAre(124));
}

TEST(BagImage, ReturnsTheLuminanceOfYuv) {
  for (const char* const name : {"yuyv", "yuv422_yuy2"}) {
    EXPECT_THAT(pixels_of(image(name, 2, 1, {10, 128, 20, 128}, 4)), ElementsAre(10, 20)) << name;
  }
  for (const char* const name : {"uyvy", "yuv422"}) {
    EXPECT_THAT(pixels_of(image(name, 2, 1, {128, 10, 128, 20}, 4)), ElementsAre(10, 20)) << name;
  }
  EXPECT_THAT(pixels_of(image("nv12", 2, 2, {1, 2, 3, 4, 128, 128}, 2)), ElementsAre(1, 2, 3, 4));
}

TEST(BagImage, ReadsSixteenBitsInBothByteOrders) {
  ros::Image message = image("mono16", 2, 1, {0x00, 0x80, 0xFF, 0xFF}, 4);
  EXPECT_THAT(pixels_of(message), ElementsAre(128, 255));
  message.is_bigendian = 1;
  message.data = {0x80, 0x00, 0xFF, 0xFF};
  EXPECT_THAT(pixels_of(message), ElementsAre(128, 255));
}

TEST(BagImage, AppliesTheBayerPattern) {
  // A red image: only red cells are bright, so grey is 0.299 of them if the pattern is read correctly.
  const std::vector<std::pair<std::string, std::vector<std::uint8_t>>> red = {{"bayer_rggb8", {200, 0, 0, 0}},
                                                                              {"bayer_bggr8", {0, 0, 0, 200}},
                                                                              {"bayer_grbg8", {0, 200, 0, 0}},
                                                                              {"bayer_gbrg8", {0, 0, 200, 0}}};
  for (const auto& [encoding, cell] : red) {
    std::vector<std::uint8_t> data;
    for (int row = 0; row < 8; ++row) {
      for (int column = 0; column < 8; ++column)
        data.push_back(cell[static_cast<std::size_t>(row % 2 * 2 + column % 2)]);
    }
    EXPECT_THAT(pixels_of(image(encoding, 8, 8, data, 8)), Each(testing::AllOf(testing::Ge(58), testing::Le(61))))
        << encoding;
  }
}

TEST(BagImage, RejectsInvalidMessagesWithAReason) {
  EXPECT_THAT(grey_of(image("jpeg2000", 2, 1, {1, 2}, 2)).failure, HasSubstr("unsupported encoding \"jpeg2000\""));
  EXPECT_EQ(grey_of(image("mono8", 2, 2, {1, 2, 3}, 2)).failure, "is not a complete image");
  EXPECT_EQ(grey_of(image("mono8", 2, 2, {1, 2, 3, 4}, 1)).failure, "is not a complete image");
  EXPECT_EQ(grey_of(image("mono8", 0, 2, {}, 0)).failure, "has an invalid size");
  EXPECT_EQ(grey_of(image("mono8", 0xFFFFFFFF, 0xFFFFFFFF, {1}, 0xFFFFFFFF)).failure, "has an invalid size");
}

TEST(BagImage, ReportsTheReasonOfOpencvFailures) {
  EXPECT_THAT(grey_of(image("mono16", 2, 2, std::vector<std::uint8_t>(10), 5)).failure,
              HasSubstr("rows of 5 bytes, not a multiple"));
  for (const auto& [encoding, width] : {std::pair("yuyv", 3u), std::pair("uyvy", 1u)}) {
    const ImageReading<Image> read =
        grey_of(image(encoding, width, 2, std::vector<std::uint8_t>(4 * width), 2 * width));
    EXPECT_TRUE(read.image || !read.failure.empty()) << encoding;
  }
  for (const char* const encoding : {"bayer_rggb8", "bayer_gbrg8"}) {
    const ImageReading<Image> read = grey_of(image(encoding, 1, 1, {7}, 1));
    EXPECT_TRUE(read.image || !read.failure.empty()) << encoding;
  }
}

}  // namespace
}  // namespace byre
