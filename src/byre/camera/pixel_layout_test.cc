#include "byre/camera/pixel_layout.h"

#include "byre/camera/still_image.h"

#include <vector>

#include <gmock/gmock.h>
#include <linux/videodev2.h>
#include <opencv2/imgcodecs.hpp>

namespace byre {
namespace {

using testing::ElementsAre;

using Bytes = std::vector<std::uint8_t>;

TEST(PixelLayout, NamesFormatsAsV4l2Does) {
  EXPECT_EQ(four_characters(V4L2_PIX_FMT_YUYV), "YUYV");
  EXPECT_EQ(four_characters(V4L2_PIX_FMT_Y10), "Y10");
  EXPECT_EQ(parse_four_characters("Y10"), V4L2_PIX_FMT_Y10);
  EXPECT_EQ(parse_four_characters("GREY"), V4L2_PIX_FMT_GREY);
  EXPECT_FALSE(parse_four_characters(""));
  EXPECT_FALSE(parse_four_characters("GREYS"));
}

TEST(PixelLayout, PrefersGreyAndRejectsUnreadableFormats) {
  EXPECT_EQ(preference_of(V4L2_PIX_FMT_GREY), 0);
  EXPECT_LT(preference_of(V4L2_PIX_FMT_YUYV), preference_of(V4L2_PIX_FMT_MJPEG));
  EXPECT_FALSE(is_readable(V4L2_PIX_FMT_H264));
  EXPECT_FALSE(preference_of(V4L2_PIX_FMT_SBGGR8));
}

TEST(PixelLayout, RemovesRowPaddingOfGrey) {
  const Bytes bytes = {1, 2, 99, 3, 4};  // the last row may lack its padding
  const auto grey = grey_of({V4L2_PIX_FMT_GREY, 2, 2, 3}, bytes);
  ASSERT_TRUE(grey);
  EXPECT_THAT(grey->pixels, ElementsAre(1, 2, 3, 4));
}

TEST(PixelLayout, UsesTheUpperEightBits) {
  const auto of = [](std::uint32_t code, std::uint16_t value) {
    const Bytes bytes = {static_cast<std::uint8_t>(value & 0xFF), static_cast<std::uint8_t>(value >> 8)};
    return grey_of({code, 1, 1, 2}, bytes)->pixels.front();
  };
  EXPECT_EQ(of(V4L2_PIX_FMT_Y10, 1023), 255);
  EXPECT_EQ(of(V4L2_PIX_FMT_Y12, 4095), 255);
  EXPECT_EQ(of(V4L2_PIX_FMT_Y16, 65535), 255);
  EXPECT_EQ(of(V4L2_PIX_FMT_Y12, 2048), 128);
}

TEST(PixelLayout, ConvertsColourToLuminance) {
  EXPECT_THAT(grey_of({V4L2_PIX_FMT_YUYV, 2, 1, 4}, Bytes{10, 128, 20, 128})->pixels, ElementsAre(10, 20));
  EXPECT_THAT(grey_of({V4L2_PIX_FMT_NV12, 2, 2, 2}, Bytes{1, 2, 3, 4, 128, 128})->pixels, ElementsAre(1, 2, 3, 4));
  EXPECT_THAT(grey_of({V4L2_PIX_FMT_RGB24, 1, 1, 3}, Bytes{255, 0, 0})->pixels, ElementsAre(76));
  EXPECT_THAT(grey_of({V4L2_PIX_FMT_BGR24, 1, 1, 3}, Bytes{255, 0, 0})->pixels, ElementsAre(29));
}

TEST(PixelLayout, DecodesCompleteJpegsOfTheRightSize) {
  Bytes bytes;
  cv::imencode(".jpg", cv::Mat(16, 24, CV_8UC1, cv::Scalar(100)), bytes);
  const auto grey = grey_of({V4L2_PIX_FMT_MJPEG, 24, 16, 0}, bytes);
  ASSERT_TRUE(grey);
  EXPECT_NEAR(grey->pixels.front(), 100, 2);
  EXPECT_FALSE(grey_of({V4L2_PIX_FMT_MJPEG, 16, 24, 0}, bytes)) << "of another size";
  bytes.resize(bytes.size() / 2);
  EXPECT_FALSE(grey_of({V4L2_PIX_FMT_MJPEG, 24, 16, 0}, bytes)) << "cut";
}

TEST(PixelLayout, RejectsTruncatedImages) {
  EXPECT_FALSE(grey_of({V4L2_PIX_FMT_GREY, 2, 2, 2}, Bytes{1, 2, 3}));
  EXPECT_FALSE(grey_of({V4L2_PIX_FMT_GREY, 2, 2, 1}, Bytes{1, 2, 3, 4})) << "rows longer than their distance";
  EXPECT_FALSE(grey_of({V4L2_PIX_FMT_YUYV, 2, 1, 4}, Bytes{10, 128}));
}

TEST(PixelLayout, SplitsSideBySideImages) {
  const ImageHalves halves = halves_of({4, 2, {1, 2, 3, 4, 5, 6, 7, 8}});
  EXPECT_EQ(halves.left.width, 2);
  EXPECT_EQ(halves.right.height, 2);
  EXPECT_THAT(halves.left.pixels, ElementsAre(1, 2, 5, 6));
  EXPECT_THAT(halves.right.pixels, ElementsAre(3, 4, 7, 8));
  EXPECT_THAT(side_by_side(halves.left, halves.right).pixels, ElementsAre(1, 2, 3, 4, 5, 6, 7, 8));
}

}  // namespace
}  // namespace byre
