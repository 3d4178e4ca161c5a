#include "byre/ros2/node/image_message.h"

#include "byre/features/image_view.h"
#include "byre/input_error.h"
#include "byre/io/ros/message_matchers.h"

#include <cstring>

#include <gmock/gmock.h>
#include <opencv2/imgcodecs.hpp>

namespace byre {
namespace {

using testing::Each;
using testing::HasSubstr;
using std::chrono_literals::operator""s;

ros::Image image_of(const std::string& encoding, std::uint32_t bytes_each, std::uint8_t value) {
  ros::Image image;
  image.header.stamp = {12, 500};
  image.width = 8;
  image.height = 4;
  image.encoding = encoding;
  image.step = 8 * bytes_each;
  image.data.assign(image.step * 4, value);
  return image;
}

Image grey_of(const ReceivedImage& received) {
  Image grey;
  EXPECT_TRUE(is_sound(received.view()));
  copy_grey(received.view(), grey);
  return grey;
}

TEST(ReceivedImage, IsConvertedToGreyFromEachEncoding) {
  for (const auto& [encoding, bytes] : std::vector<std::pair<std::string, std::uint32_t>>{{"mono8", 1},
                                                                                          {"8UC1", 1},
                                                                                          {"mono16", 2},
                                                                                          {"bgr8", 3},
                                                                                          {"rgb8", 3},
                                                                                          {"bgra8", 4},
                                                                                          {"rgba8", 4},
                                                                                          {"yuv422_yuy2", 2},
                                                                                          {"yuyv", 2},
                                                                                          {"uyvy", 2},
                                                                                          {"yuv422", 2},
                                                                                          {"bayer_rggb8", 1},
                                                                                          {"bayer_gbrg8", 1}}) {
    const ReceivedImage received = received_image(image_of(encoding, bytes, 90), "/left");
    const Image grey = grey_of(received);
    ASSERT_EQ(grey.width, 8) << encoding;
    ASSERT_EQ(grey.height, 4) << encoding;
    EXPECT_THAT(grey.pixels, Each(testing::AllOf(testing::Ge(89), testing::Le(91)))) << encoding;
    EXPECT_EQ(received.view().time, Timestamp(12'000'000'500)) << encoding;
  }
}

// A pure colour has its luminance as grey value in each order of channels.
TEST(ReceivedImage, WeightsColoursByTheOrderOfTheChannels) {
  const auto grey = [](const std::string& encoding, std::vector<std::uint8_t> pixel) {
    ros::Image image = image_of(encoding, static_cast<std::uint32_t>(pixel.size()), 0);
    for (std::size_t i = 0; i < image.data.size(); ++i) image.data[i] = pixel[i % pixel.size()];
    return grey_of(received_image(image, "/left")).pixels;
  };
  EXPECT_THAT(grey("rgb8", {200, 0, 0}), Each(60)) << "0.299 of red";
  EXPECT_THAT(grey("bgr8", {0, 0, 200}), Each(60));
  EXPECT_THAT(grey("8UC3", {0, 0, 200}), Each(60));
  EXPECT_THAT(grey("rgba8", {200, 0, 0, 255}), Each(60));
  EXPECT_THAT(grey("bgra8", {0, 0, 200, 255}), Each(60));
  EXPECT_THAT(grey("rgb8", {0, 0, 200}), Each(23)) << "0.114 of blue";
}

TEST(ReceivedImage, AppliesTheBayerPattern) {
  for (const auto& [encoding, red] : {std::pair("bayer_rggb8", 0u), std::pair("bayer_grbg8", 1u),
                                      std::pair("bayer_gbrg8", 2u), std::pair("bayer_bggr8", 3u)}) {
    ros::Image image = image_of(encoding, 1, 0);
    for (std::uint32_t i = 0; i < 32; ++i) {
      if (2 * (i / 8 % 2) + i % 2 == red) image.data[i] = 200;
    }
    EXPECT_NEAR(grey_of(received_image(image, "/left")).pixels[8 + 3], 60, 2) << encoding;
  }
}

ros::Image depth_image(const std::string& encoding, std::uint32_t bytes_each) {
  return image_of(encoding, bytes_each, 0);
}

TEST(ReceivedDepth, IsReadInMillimetresAndMetres) {
  ros::Image millimetres = depth_image("16UC1", 2);
  const std::uint16_t value = 1234;
  std::memcpy(millimetres.data.data() + 2, &value, 2);
  const ReceivedDepth read = received_depth(millimetres, "/depth");
  EXPECT_EQ(read.image.units[0], 0);
  EXPECT_EQ(read.image.units[1], 1234);
  EXPECT_FALSE(read.is_in_metres);
  EXPECT_EQ(read.header.stamp.sec, 12);
  EXPECT_TRUE(is_sound(read.view(1s)));
  EXPECT_EQ(read.view(1s).format, PixelFormat::depth16);
  EXPECT_EQ(read.view(1s).time, 1s);
  ros::Image metres = depth_image("32FC1", 4);
  const float depth = 1.5f;
  std::memcpy(metres.data.data() + 4, &depth, 4);
  EXPECT_EQ(received_depth(metres, "/depth").image.units[1], 7500) << "units of 0.2 mm";
  EXPECT_TRUE(received_depth(metres, "/depth").is_in_metres);
}

TEST(ReceivedDepth, IsReadFromCompressedDepth) {
  ros::CompressedImage message;
  message.format = "16UC1; compressedDepth png";
  cv::imencode(".png", cv::Mat(4, 8, CV_16UC1, cv::Scalar(1234)), message.data);
  message.data.insert(message.data.begin(), 12, 0);
  EXPECT_THAT(received_depth(message, "/depth").image.units, Each(1234));
  EXPECT_EQ(received_depth(message, "/depth").image.width, 8);
}

TEST(ReceivedDepth, RefusesOtherImagesWithARemedy) {
  const auto refusal = [](const auto& message) -> std::string {
    try {
      received_depth(message, "/depth");
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_THAT(refusal(depth_image("mono8", 1)),
              testing::AllOf(HasSubstr("/depth: has an image that has the encoding \"mono8\""),
                             HasSubstr("set the depth camera driver to 16UC1 or 32FC1")));
  ros::Image cut = depth_image("16UC1", 2);
  cut.data.resize(20);
  EXPECT_THAT(refusal(cut), HasSubstr("/depth: has an image that is not a complete depth image"));
  ros::CompressedImage rvl;
  rvl.format = "16UC1; compressedDepth rvl";
  EXPECT_THAT(refusal(rvl), HasSubstr("RVL"));
}

TEST(ReceivedImage, ReadsLuminanceOfUyvyFromTheSecondByte) {
  ros::Image image = image_of("uyvy", 2, 10);
  for (std::size_t i = 1; i < image.data.size(); i += 2) image.data[i] = 200;
  EXPECT_THAT(grey_of(received_image(image, "/left")).pixels, Each(200));
}

TEST(ReceivedImage, ReadsRowsWithPadding) {
  ros::Image image = image_of("mono8", 1, 7);
  image.step = 13;
  image.data.assign(13 * 4, 7);
  EXPECT_THAT(grey_of(received_image(image, "/left")).pixels, Each(7));
}

TEST(ReceivedImage, RejectsSizesThatContradictTheData) {
  const auto refusal = [](auto change) {
    ros::Image image = image_of("mono8", 1, 7);
    change(image);
    EXPECT_THROW(received_image(image, "/left"), InputError);
  };
  refusal([](ros::Image& image) { image.height = 5; });
  refusal([](ros::Image& image) { image.step = 7; });
  refusal([](ros::Image& image) { image.width = 0; });
  refusal([](ros::Image& image) { image.height = 0xFFFFFFFF; });
  refusal([](ros::Image& image) { image.step = 0xFFFFFFFF, image.height = 0xFFFFFFFF; });
  refusal([](ros::Image& image) { image.data.clear(); });
  refusal([](ros::Image& image) { image.encoding = "thermal"; });
}

TEST(ReceivedImage, IsDecodedFromJpegAndPng) {
  const cv::Mat grey(20, 30, CV_8UC1, cv::Scalar(120));
  for (const char* const kind : {".jpg", ".png"}) {
    ros::CompressedImage message;
    message.format = "mono8; compressed";
    cv::imencode(kind, grey, message.data);
    const ReceivedImage received = received_image(message, "/left");
    EXPECT_EQ(received.view().width, 30);
    EXPECT_THAT(grey_of(received).pixels, Each(testing::AllOf(testing::Ge(118), testing::Le(122))));
    message.data.resize(10);
    try {
      received_image(message, "/left");
      ADD_FAILURE() << kind;
    } catch (const InputError& error) {
      EXPECT_THAT(error.what(), HasSubstr("/left: has an image that is not a complete JPEG or PNG"));
    }
  }
}

}  // namespace
}  // namespace byre
