#include "byre/features/remap.h"

#include <cmath>
#include <cstdint>
#include <random>

#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

namespace byre {
namespace {

cv::Mat noise(cv::Size size) {
  cv::Mat image(size, CV_8U);
  std::mt19937 random(5);
  for (int y = 0; y < size.height; ++y) {
    for (int x = 0; x < size.width; ++x) image.at<std::uint8_t>(y, x) = static_cast<std::uint8_t>(random());
  }
  return image;
}

struct Places {
  cv::Mat columns;
  cv::Mat rows;
};

// A turned and magnified source, some of it outside.
Places turned(cv::Size size, cv::Size source) {
  Places places{cv::Mat(size, CV_32F), cv::Mat(size, CV_32F)};
  for (int v = 0; v < size.height; ++v) {
    for (int u = 0; u < size.width; ++u) {
      const auto along = static_cast<float>(u) / static_cast<float>(size.width - 1);
      const auto down = static_cast<float>(v) / static_cast<float>(size.height - 1);
      const auto width = static_cast<float>(source.width), height = static_cast<float>(source.height);
      places.columns.at<float>(v, u) = (1.1f * along - 0.05f + 0.07f * down) * width;
      places.rows.at<float>(v, u) = (1.1f * down - 0.05f - 0.06f * along) * height;
    }
  }
  return places;
}

TEST(Remap, GivesTheValuesOfOpenCv) {
  for (const cv::Size source : {cv::Size(160, 120), cv::Size(33, 7), cv::Size(2, 2), cv::Size(3, 2)}) {
    for (const cv::Size size : {source, cv::Size(101, 57)}) {
      const cv::Mat image = noise(source);
      const Places places = turned(size, source);
      cv::Mat made, expected, whole, fraction;
      Remap(places.columns, places.rows, source).apply(image, made);
      cv::convertMaps(places.columns, places.rows, whole, fraction, CV_16SC2);
      cv::remap(image, expected, whole, fraction, cv::INTER_LINEAR, cv::BORDER_REPLICATE);
      EXPECT_EQ(cv::countNonZero(made != expected), 0) << source << " to " << size;
    }
  }
}

TEST(Remap, TellsTheRowThatAPixelComesFrom) {
  const cv::Size size(80, 60);
  const Places places = turned(size, size);
  const Remap remap(places.columns, places.rows, size);
  EXPECT_EQ(remap.source_row({40, 30}), static_cast<int>(std::floor(places.rows.at<float>(30, 40))));
  EXPECT_EQ(remap.source_row({79, 0}), 0) << "above the image";
}

}  // namespace
}  // namespace byre
