#include "byre/io/image/image_file.h"

#include "byre/io/recording/folder_scene.h"

#include <gmock/gmock.h>
#include <sys/resource.h>

namespace byre {
namespace {

// Prevents opening further files during its lifetime.
class NoDescriptors {
 public:
  NoDescriptors() {
    getrlimit(RLIMIT_NOFILE, &before_);
    const rlimit none{0, before_.rlim_max};
    setrlimit(RLIMIT_NOFILE, &none);
  }
  ~NoDescriptors() { setrlimit(RLIMIT_NOFILE, &before_); }
  NoDescriptors(const NoDescriptors&) = delete;
  NoDescriptors& operator=(const NoDescriptors&) = delete;

 private:
  rlimit before_{};
};

using ReadImage = TestFolder;

TEST_F(ReadImage, KeepsThePixelsOfAPng) {
  write_image("a.png", 5, 3, 77);
  const std::optional<Image> image = read_image(folder_ / "a.png");
  ASSERT_TRUE(image.has_value());
  EXPECT_EQ(image->width, 5);
  EXPECT_EQ(image->height, 3);
  ASSERT_EQ(image->pixels.size(), 15u);
  EXPECT_EQ(image->pixels[0], 0);
  EXPECT_EQ(image->pixels[14], 77);
}

TEST_F(ReadImage, ReadsJpegAndConvertsColourToGrey) {
  write_image("a.jpg", 64, 48, 120);
  cv::imwrite((folder_ / "b.png").string(), cv::Mat(2, 2, CV_8UC3, cv::Scalar(50, 50, 50)));
  const std::optional<Image> jpeg = read_image(folder_ / "a.jpg");
  const std::optional<Image> colour = read_image(folder_ / "b.png");
  ASSERT_TRUE(jpeg && colour);
  EXPECT_NEAR(jpeg->pixels.back(), 120, 2);
  EXPECT_EQ(colour->pixels, std::vector<std::uint8_t>(4, 50));
}

TEST_F(ReadImage, KeepsTheUpperByteOfSixteenBitsAndIgnoresAlpha) {
  cv::imwrite((folder_ / "deep.png").string(), cv::Mat(2, 3, CV_16U, cv::Scalar(0x50A0)));
  cv::imwrite((folder_ / "clear.png").string(), cv::Mat(2, 3, CV_8UC4, cv::Scalar(90, 90, 90, 10)));
  const std::optional<Image> deep = read_image(folder_ / "deep.png");
  const std::optional<Image> clear = read_image(folder_ / "clear.png");
  ASSERT_TRUE(deep && clear);
  EXPECT_NEAR(deep->pixels.front(), 0x50, 1);
  EXPECT_EQ(clear->pixels, std::vector<std::uint8_t>(6, 90));
}

// The decoder itself would print a warning.
TEST_F(ReadImage, PrintsNothingForADamagedFile) {
  cv::imwrite((folder_ / "cut.png").string(), cv::Mat(480, 640, CV_8U, cv::Scalar(77)));
  cut_in_half("cut.png");
  testing::internal::CaptureStderr();
  EXPECT_FALSE(read_image(folder_ / "cut.png"));
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
}

using ReadDepthImage = TestFolder;

TEST_F(ReadDepthImage, KeepsAllSixteenBits) {
  cv::Mat depth(2, 3, CV_16U, cv::Scalar(0));
  depth.at<std::uint16_t>(0, 2) = 5001;
  depth.at<std::uint16_t>(1, 0) = 65535;
  cv::imwrite((folder_ / "depth.png").string(), depth);
  const std::optional<DepthImage> image = read_depth_image(folder_ / "depth.png");
  ASSERT_TRUE(image);
  EXPECT_EQ(image->width, 3);
  EXPECT_EQ(image->height, 2);
  EXPECT_EQ(image->units, (std::vector<std::uint16_t>{0, 0, 5001, 65535, 0, 0}));
}

TEST_F(ReadDepthImage, IsEmptyForOtherThanCompleteDepthImages) {
  write_image("grey.png", 4, 3, 90);
  cv::imwrite((folder_ / "colour.png").string(), cv::Mat(2, 2, CV_16UC3, cv::Scalar(1, 2, 3)));
  cv::imwrite((folder_ / "cut.png").string(), cv::Mat(480, 640, CV_16U, cv::Scalar(777)));
  cut_in_half("cut.png");
  write("text.png", "no image");
  for (const char* const name : {"grey.png", "colour.png", "cut.png", "text.png", "absent.png"}) {
    EXPECT_FALSE(read_depth_image(folder_ / name)) << name;
  }
}

TEST_F(ReadImage, IsEmptyForIncompleteImages) {
  write_image("cut.png", 640, 480, 90);
  write_image("cut.jpg", 640, 480, 90);
  cut_in_half("cut.png");
  cut_in_half("cut.jpg");
  write("text.png", "no image");
  write("empty.png", "");
  for (const char* const name : {"cut.png", "cut.jpg", "text.png", "empty.png", "absent.png"}) {
    EXPECT_FALSE(read_image(folder_ / name).has_value()) << name;
  }
  EXPECT_FALSE(read_image(folder_).has_value());
}

TEST_F(ReadImage, DistinguishesUnreadableMissingAndBrokenFiles) {
  write_image("whole.png", 5, 3, 77);
  write("text.png", "no image");
  EXPECT_EQ(try_image(folder_ / "text.png").failure, "is not a complete image");
  EXPECT_EQ(try_depth_image(folder_ / "text.png").failure, "is not a complete 16-bit image");
  EXPECT_EQ(try_image(folder_ / "absent.png").failure, "does not exist");
  EXPECT_EQ(try_image(folder_).failure, "cannot be read: Is a directory");
  {
    const NoDescriptors none;
    EXPECT_EQ(try_image(folder_ / "whole.png").failure, "cannot be opened: Too many open files");
  }
  EXPECT_EQ(try_image(folder_ / "whole.png").failure, "");
}

}  // namespace
}  // namespace byre
