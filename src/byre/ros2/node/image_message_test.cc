#include "byre/ros2/node/image_message.h"

#include "byre/features/image_view.h"
#include "byre/input_error.h"

#include <gmock/gmock.h>
#include <opencv2/imgcodecs.hpp>

namespace byre {
namespace {

using testing::Each;
using testing::HasSubstr;

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
