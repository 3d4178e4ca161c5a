#include "byre/dataset/image_file.h"

#include "byre/dataset/test_folder.h"

namespace byre {
namespace {

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

TEST_F(ReadImage, ReadsJpegAndTurnsColourIntoGrey) {
  write_image("a.jpg", 64, 48, 120);
  cv::imwrite((folder_ / "b.png").string(), cv::Mat(2, 2, CV_8UC3, cv::Scalar(50, 50, 50)));
  const std::optional<Image> jpeg = read_image(folder_ / "a.jpg");
  const std::optional<Image> colour = read_image(folder_ / "b.png");
  ASSERT_TRUE(jpeg && colour);
  EXPECT_NEAR(jpeg->pixels.back(), 120, 2);
  EXPECT_EQ(colour->pixels, std::vector<std::uint8_t>(4, 50));
}

TEST_F(ReadImage, TakesTheUpperByteOfSixteenBitsAndLeavesTransparencyOut) {
  cv::imwrite((folder_ / "deep.png").string(), cv::Mat(2, 3, CV_16U, cv::Scalar(0x50A0)));
  cv::imwrite((folder_ / "clear.png").string(), cv::Mat(2, 3, CV_8UC4, cv::Scalar(90, 90, 90, 10)));
  const std::optional<Image> deep = read_image(folder_ / "deep.png");
  const std::optional<Image> clear = read_image(folder_ / "clear.png");
  ASSERT_TRUE(deep && clear);
  EXPECT_NEAR(deep->pixels.front(), 0x50, 1);
  EXPECT_EQ(clear->pixels, std::vector<std::uint8_t>(6, 90));
}

TEST_F(ReadImage, IsEmptyForWhatIsNoWholeImage) {
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

}  // namespace
}  // namespace byre
