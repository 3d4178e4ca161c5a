#include "byre/features/downscale.h"

#include <cstdint>
#include <random>
#include <tuple>

#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

namespace byre {
namespace {

cv::Mat noise(cv::Size size) {
  cv::Mat image(size, CV_8U);
  std::mt19937 random(11);
  for (int y = 0; y < size.height; ++y) {
    for (int x = 0; x < size.width; ++x) image.at<std::uint8_t>(y, x) = static_cast<std::uint8_t>(random());
  }
  return image;
}

class DownscaleOf : public testing::TestWithParam<std::tuple<int, int, double>> {};  // width, height, factor

TEST_P(DownscaleOf, GivesTheValuesOfOpenCv) {
  const auto [width, height, factor] = GetParam();
  const cv::Mat image = noise({width, height});
  const Downscale downscale(image.size(), factor);
  cv::Mat made, expected;
  downscale.apply(image, made);
  cv::resize(image, expected, cv::Size(), 1.0 / factor, 1.0 / factor, cv::INTER_LINEAR);
  ASSERT_EQ(made.size(), expected.size());
  EXPECT_EQ(cv::countNonZero(made != expected), 0);
}

INSTANTIATE_TEST_SUITE_P(Sizes, DownscaleOf,
                         testing::Values(std::tuple{24, 24, 1.2}, std::tuple{752, 480, 1.2}, std::tuple{627, 400, 1.2},
                                         std::tuple{1241, 37, 1.2}, std::tuple{101, 99, 1.8}, std::tuple{64, 31, 1.01},
                                         std::tuple{640, 47, 1.5}));

}  // namespace
}  // namespace byre
