#include "byre/io/image/image_codec.h"

#include "byre/input_error.h"
#include "byre/io/recording/folder_scene.h"

#include <gtest/gtest.h>
#include <opencv2/imgcodecs.hpp>

namespace byre {
namespace {

class ImageCodec : public TestFolder {};

const cv::Mat kPixels = (cv::Mat_<std::uint8_t>(2, 3) << 0, 10, 20, 30, 250, 255);

bool are_equal(const cv::Mat& a, const cv::Mat& b) {
  return a.size() == b.size() && a.type() == b.type() && cv::norm(a, b, cv::NORM_INF) == 0.0;
}

TEST_F(ImageCodec, DecodesWhatItEncodes) {
  EXPECT_TRUE(are_equal(decode_image(encode_image(".png", kPixels), cv::IMREAD_UNCHANGED), kPixels));
  write_image_file(folder_ / "a.png", kPixels);
  EXPECT_TRUE(are_equal(decode_image_file(folder_ / "a.png", cv::IMREAD_UNCHANGED), kPixels));
}

TEST_F(ImageCodec, EncodesLikeOpencv) {
  std::vector<std::uint8_t> bytes;
  cv::imencode(".jpg", kPixels, bytes, {cv::IMWRITE_JPEG_QUALITY, 60});
  EXPECT_EQ(encode_image(".jpg", kPixels, {cv::IMWRITE_JPEG_QUALITY, 60}), bytes);
}

TEST_F(ImageCodec, RejectsOtherBytesAndMissingFiles) {
  EXPECT_TRUE(decode_image({1, 2, 3, 4}, cv::IMREAD_GRAYSCALE).empty());
  EXPECT_TRUE(decode_image_file(folder_ / "none.png", cv::IMREAD_GRAYSCALE).empty());
  EXPECT_THROW(write_image_file(folder_ / "missing" / "a.png", kPixels), InputError);
}

TEST(OpencvLibrary, ReportsTheMissingModule) {
  try {
    find_function(OpencvLibrary::videos, "no_such_function");
    FAIL();
  } catch (const InputError& error) {
    EXPECT_NE(error.place().find("opencv_videoio"), std::string::npos);
    EXPECT_NE(error.reason().find("no_such_function"), std::string::npos);
  }
}

}  // namespace
}  // namespace byre
