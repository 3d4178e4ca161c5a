#include "byre/features/pyramid.h"

#include "byre/features/image_scene.h"

#include <tuple>

#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

namespace byre {
namespace {

class DownscaleOf : public testing::TestWithParam<std::tuple<int, int, double>> {};  // width, height, factor

TEST_P(DownscaleOf, MatchesOpencv) {
  const auto [width, height, factor] = GetParam();
  const cv::Mat image = white_noise({width, height}, 11);
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
