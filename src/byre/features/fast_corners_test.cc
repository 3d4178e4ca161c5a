#include "byre/features/fast_corners.h"

#include "byre/features/image_scene.h"

#include <cstdint>
#include <vector>

#include <gtest/gtest.h>
#include <opencv2/features2d.hpp>
#include <opencv2/imgproc.hpp>

namespace byre {
namespace {

cv::Mat noise_to_search(int width, int height, double blur) {
  cv::Mat image = white_noise({width, height}, 7);
  if (blur > 0.0) cv::GaussianBlur(image, image, {0, 0}, blur);
  return image;
}

// Strengths by OpenCV's detector: its response plus one.
cv::Mat expected_strengths(const cv::Mat& image, const cv::Rect& area, int threshold) {
  std::vector<cv::KeyPoint> corners;
  // OpenCV reports responses only with non-maximum suppression, so each pixel is tested alone.
  cv::Mat expected = cv::Mat::zeros(image.size(), CV_8U);
  for (int y = area.y; y < area.y + area.height; ++y) {
    for (int x = area.x; x < area.x + area.width; ++x) {
      cv::FAST(image(cv::Rect(x - kFastRadius, y - kFastRadius, 7, 7)), corners, threshold, true);
      if (!corners.empty()) expected.at<std::uint8_t>(y, x) = static_cast<std::uint8_t>(corners[0].response + 1.0f);
    }
  }
  return expected;
}

class FastStrength : public testing::TestWithParam<int> {};  // width of the area, pixels

TEST_P(FastStrength, MatchesOpencv) {
  for (const double blur : {0.0, 0.8}) {
    for (const int threshold : {7, 20}) {
      const cv::Mat image = noise_to_search(GetParam() + 9, 40, blur);
      const cv::Rect area(4, 3, GetParam(), 34);
      cv::Mat strengths;
      measure_fast_strengths(image, area, threshold, strengths);
      const cv::Mat expected = expected_strengths(image, area, threshold);
      EXPECT_GT(cv::countNonZero(expected), 10);
      EXPECT_EQ(cv::countNonZero(strengths != expected), 0) << "blur " << blur << ", threshold " << threshold;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Widths, FastStrength, testing::Values(9, 32, 33, 95));

class FastPeaks : public testing::TestWithParam<int> {};  // width of the area, pixels

TEST_P(FastPeaks, MatchOpencv) {
  for (const int threshold : {7, 20}) {
    const cv::Mat image = noise_to_search(GetParam() + 9, 60, 0.8);
    const cv::Rect area(4, 3, GetParam(), 54);
    cv::Mat strengths;
    measure_fast_strengths(image, area, 7, strengths);
    ScratchVector<Corner> corners;
    append_peaks(strengths, area, threshold, corners);

    std::vector<cv::KeyPoint> expected;
    cv::FAST(image(cv::Rect(area.x - kFastRadius, area.y - kFastRadius, area.width + 2 * kFastRadius,
                            area.height + 2 * kFastRadius)),
             expected, threshold, true);
    ASSERT_EQ(corners.size(), expected.size());
    EXPECT_GT(corners.size(), 5u);
    for (std::size_t i = 0; i < corners.size(); ++i) {
      EXPECT_EQ(corners[i].x, static_cast<int>(expected[i].pt.x) + area.x - kFastRadius);
      EXPECT_EQ(corners[i].y, static_cast<int>(expected[i].pt.y) + area.y - kFastRadius);
      EXPECT_EQ(corners[i].response, expected[i].response);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Widths, FastPeaks, testing::Values(20, 32, 33, 95));

TEST(FastStrength, IsZeroInAUniformImage) {
  cv::Mat strengths;
  measure_fast_strengths(cv::Mat(20, 60, CV_8U, cv::Scalar(200)), {3, 3, 54, 14}, 7, strengths);
  EXPECT_EQ(cv::countNonZero(strengths), 0);
}

}  // namespace
}  // namespace byre
