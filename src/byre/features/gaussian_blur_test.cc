#include "byre/features/gaussian_blur.h"

#include "byre/features/image_scene.h"

#include <utility>

#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

namespace byre {
namespace {

class GaussianBlurOf : public testing::TestWithParam<std::pair<int, int>> {};  // width and height, pixels

TEST_P(GaussianBlurOf, MatchesOpencv) {
  const cv::Mat image = white_noise({GetParam().first, GetParam().second}, 3);
  cv::Mat blurred, expected;
  gaussian_blur(image, blurred);
  cv::GaussianBlur(image, expected, {7, 7}, 2.0, 2.0, cv::BORDER_REFLECT_101);
  EXPECT_EQ(cv::countNonZero(blurred != expected), 0);
}

INSTANTIATE_TEST_SUITE_P(Sizes, GaussianBlurOf,
                         testing::Values(std::pair{4, 4}, std::pair{13, 5}, std::pair{48, 48}, std::pair{97, 61},
                                         std::pair{752, 48}));

TEST(GaussianBlur, LeavesAUniformImage) {
  for (const int grey : {0, 1, 254, 255}) {
    const cv::Mat image(20, 64, CV_8U, cv::Scalar(grey));
    cv::Mat blurred;
    gaussian_blur(image, blurred);
    EXPECT_EQ(cv::countNonZero(blurred != image), 0) << grey;
  }
}

TEST(GaussianBlur, AcceptsPartOfAnImage) {
  const cv::Mat whole = white_noise({120, 60}, 5);
  const cv::Mat part = whole(cv::Rect(7, 9, 81, 33));
  cv::Mat blurred, expected;
  gaussian_blur(part, blurred);
  gaussian_blur(part.clone(), expected);
  EXPECT_EQ(cv::countNonZero(blurred != expected), 0);
}

}  // namespace
}  // namespace byre
