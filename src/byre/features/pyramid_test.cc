#include "byre/features/pyramid.h"

#include "byre/features/image_scene.h"
#include "byre/geometry/geometry_matchers.h"

#include <cmath>

#include <gtest/gtest.h>

namespace byre {
namespace {

cv::Mat blob_image(const cv::Size& size, const Eigen::Vector2d& centre, double sigma) {
  return render(size.width, size.height, [&](double x, double y) {
    return 250.0 * std::exp(-0.5 * (Eigen::Vector2d(x, y) - centre).squaredNorm() / (sigma * sigma));
  });
}

Eigen::Vector2f centroid(const cv::Mat& level) {
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  double weight = 0.0;
  for (int y = 0; y < level.rows; ++y) {
    for (int x = 0; x < level.cols; ++x) {
      const double grey = level.at<std::uint8_t>(y, x);
      sum += grey * Eigen::Vector2d(x, y);
      weight += grey;
    }
  }
  return (sum / weight).cast<float>();
}

TEST(BuildPyramid, KeepsTheFullResolutionPositionInEveryOctave) {
  const Eigen::Vector2d centre(143.3, 118.7);
  for (const cv::Size size : {cv::Size(320, 240), cv::Size(333, 251), cv::Size(376, 240)}) {
    Pyramid pyramid;
    build_pyramid(blob_image(size, centre, 12.0), pyramid);
    for (int octave = 0; octave < kOctaves; ++octave) {
      const cv::Mat& level = pyramid.levels[static_cast<std::size_t>(octave)];
      ASSERT_FALSE(level.empty()) << octave;
      EXPECT_THAT(full_from_octave(centroid(level), octave), PointNear(centre.cast<float>(), 0.05)) << octave;
    }
  }
}

TEST(BuildPyramid, ShrinksEachOctaveByTheScale) {
  Pyramid pyramid;
  build_pyramid(cv::Mat(480, 752, CV_8U, cv::Scalar(7)), pyramid);
  for (std::size_t octave = 0; octave < kOctaves; ++octave) {
    EXPECT_NEAR(static_cast<float>(pyramid.levels[octave].cols), 752.0f / kScaleOfOctave[octave], 2.0f);
    EXPECT_NEAR(static_cast<float>(pyramid.levels[octave].rows), 480.0f / kScaleOfOctave[octave], 2.0f);
    EXPECT_EQ(pyramid.levels[octave].at<std::uint8_t>(3, 3), 7);
  }
}

TEST(BuildPyramid, UsesTheImageAsOctaveZero) {
  const cv::Mat image(120, 160, CV_8U, cv::Scalar(50));
  Pyramid pyramid;
  build_pyramid(image, pyramid);
  EXPECT_EQ(pyramid.levels[0].data, image.data);
}

TEST(BuildPyramid, LeavesOctavesEmptyForASmallImage) {
  Pyramid pyramid;
  build_pyramid(cv::Mat(480, 752, CV_8U, cv::Scalar(7)), pyramid);
  build_pyramid(cv::Mat(70, 90, CV_8U, cv::Scalar(7)), pyramid);  // reuses the pyramid: no old octave may remain
  EXPECT_EQ(pyramid.levels[1].rows, 58);
  for (std::size_t octave = 3; octave < kOctaves; ++octave) EXPECT_TRUE(pyramid.levels[octave].empty()) << octave;
}

TEST(FullFromOctave, InvertsOctaveFromFull) {
  const Eigen::Vector2f pixel(123.4f, -5.6f);
  for (int octave = 0; octave < kOctaves; ++octave) {
    EXPECT_THAT(octave_from_full(full_from_octave(pixel, octave), octave), PointNear(pixel, 1e-4)) << octave;
  }
}

TEST(FullFromOctave, KeepsTheCornerOfTheImage) {
  const Eigen::Vector2f corner(-0.5f, -0.5f);  // corner of the top-left pixel, in every octave
  for (int octave = 0; octave < kOctaves; ++octave) {
    EXPECT_THAT(full_from_octave(corner, octave), PointNear(corner, 1e-6)) << octave;
  }
}

}  // namespace
}  // namespace byre
