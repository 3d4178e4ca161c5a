#include "byre/features/image_view.h"

#include <array>
#include <limits>
#include <vector>

#include <gmock/gmock.h>

namespace byre {
namespace {

using testing::ElementsAre;

template <typename Number>
ImageView view(const std::vector<Number>& data, int width, int height, PixelFormat format, std::size_t stride = 0) {
  return {data.data(), width, height, stride, format};
}

std::vector<std::uint8_t> grey(const ImageView& view) {
  Image image;
  copy_grey(view, image);
  EXPECT_EQ(image.width, view.width);
  EXPECT_EQ(image.height, view.height);
  return image.pixels;
}

std::vector<std::uint16_t> depths(const ImageView& view, double units_per_metre) {
  DepthImage image;
  copy_depth(view, units_per_metre, image);
  return image.units;
}

TEST(ImageView, KeepsGreyValues) {
  const std::vector<std::uint8_t> pixels = {1, 2, 3, 4, 5, 6};
  EXPECT_THAT(grey(view(pixels, 3, 2, PixelFormat::grey8)), ElementsAre(1, 2, 3, 4, 5, 6));
}

TEST(ImageView, IgnoresRowPadding) {
  const std::vector<std::uint8_t> pixels = {1, 2, 99, 99, 3, 4, 99, 99};
  EXPECT_THAT(grey(view(pixels, 2, 2, PixelFormat::grey8, 4)), ElementsAre(1, 2, 3, 4));
}

TEST(ImageView, ScalesSixteenBitsToTheirRange) {
  const std::vector<std::uint16_t> pixels = {0, 4095, 2048};
  ImageView twelve = view(pixels, 3, 1, PixelFormat::grey16);
  twelve.bits = 12;
  EXPECT_THAT(grey(twelve), ElementsAre(0, 255, 128));
  const std::vector<std::uint16_t> all = {0, 65535, 257};
  EXPECT_THAT(grey(view(all, 3, 1, PixelFormat::grey16)), ElementsAre(0, 255, 1));
}

TEST(ImageView, WeightsColoursByLuminance) {
  const std::vector<std::uint8_t> red_and_blue = {255, 0, 0, 0, 0, 255};
  EXPECT_THAT(grey(view(red_and_blue, 2, 1, PixelFormat::rgb8)), ElementsAre(76, 29));
  EXPECT_THAT(grey(view(red_and_blue, 2, 1, PixelFormat::bgr8)), ElementsAre(29, 76));
}

TEST(ImageView, ReadsTheLuminanceOfYuv) {
  const std::vector<std::uint8_t> yuyv = {10, 128, 20, 128};
  EXPECT_THAT(grey(view(yuyv, 2, 1, PixelFormat::yuyv)), ElementsAre(10, 20));
  const std::vector<std::uint8_t> nv12 = {10, 20, 30, 40, 128, 128};
  EXPECT_THAT(grey(view(nv12, 2, 2, PixelFormat::nv12)), ElementsAre(10, 20, 30, 40));
}

TEST(ImageView, IsCopiedWithItsLayout) {
  std::vector<std::uint8_t> left = {1, 2, 99, 99, 3, 4};  // the last row has no padding
  std::vector<std::uint8_t> right = {10, 20, 30, 40, 128, 128};
  std::vector<std::uint16_t> depth = {0, 1500};
  CameraImages images{view(left, 2, 2, PixelFormat::grey8, 4)};
  images.right = view(right, 2, 2, PixelFormat::nv12);
  images.depth = view(depth, 2, 1, PixelFormat::depth16);
  const CopiedImages copy(images);
  left.assign(left.size(), 0);
  right.assign(right.size(), 0);
  depth.assign(depth.size(), 0);
  EXPECT_THAT(grey(copy.views().left), ElementsAre(1, 2, 3, 4));
  EXPECT_THAT(grey(*copy.views().right), ElementsAre(10, 20, 30, 40));
  EXPECT_THAT(depths(*copy.views().depth, 1000.0), ElementsAre(0, 1500));
}

TEST(ImageView, IsNotReadIfUnsound) {
  const std::vector<std::uint8_t> pixels = {1};
  CameraImages images{view(pixels, 1000, 1000, PixelFormat::grey8, 1)};
  images.right = ImageView{};
  const CopiedImages copy(images);
  EXPECT_FALSE(is_sound(copy.views().left));
  EXPECT_NE(copy.views().left.data, nullptr);
  EXPECT_EQ(copy.views().right->data, nullptr);
}

TEST(ImageView, ReturnsDepthsInCameraUnits) {
  const std::vector<std::uint16_t> millimetres = {0, 1500};
  EXPECT_THAT(depths(view(millimetres, 2, 1, PixelFormat::depth16), 1000.0), ElementsAre(0, 1500));
  const std::vector<float> metres = {1.5f, 0.0f, -1.0f, std::numeric_limits<float>::quiet_NaN(), 1e9f};
  EXPECT_THAT(depths(view(metres, 5, 1, PixelFormat::depth_metres), 1000.0), ElementsAre(1500, 0, 0, 0, 0));
}

TEST(ImageView, RejectsShortRowsAndInvalidSizes) {
  const std::vector<std::uint8_t> bytes(100);
  EXPECT_TRUE(is_sound(view(bytes, 4, 2, PixelFormat::rgb8, 12)));
  EXPECT_FALSE(is_sound(view(bytes, 4, 2, PixelFormat::rgb8, 11)));
  EXPECT_FALSE(is_sound(view(bytes, 0, 2, PixelFormat::grey8)));
  EXPECT_FALSE(is_sound(view(bytes, 3, 2, PixelFormat::yuyv)));
  EXPECT_FALSE(is_sound(view(bytes, 4, 3, PixelFormat::nv12)));
  EXPECT_FALSE(is_sound(view(bytes, 4, 2, PixelFormat::grey16, 9))) << "a number across two rows";
  ImageView bits = view(bytes, 2, 2, PixelFormat::grey16);
  bits.bits = 17;
  EXPECT_FALSE(is_sound(bits));
}

TEST(ImageView, ShowsARecordedFrame) {
  ImageFrame frame;
  frame.time = Timestamp(7);
  frame.left = {2, 1, {1, 2}};
  frame.right = Image{2, 1, {3, 4}};
  frame.depth = DepthImage{2, 1, {5, 6}};
  const CameraImages images = view_of(frame);
  EXPECT_EQ(images.left.time, frame.time);
  EXPECT_THAT(grey(images.left), ElementsAre(1, 2));
  EXPECT_THAT(grey(images.right.value()), ElementsAre(3, 4));
  EXPECT_THAT(depths(images.depth.value(), 1.0), ElementsAre(5, 6));
}

}  // namespace
}  // namespace byre
