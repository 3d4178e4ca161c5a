#include "byre/features/remap.h"

#include "byre/features/image_scene.h"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

namespace byre {
namespace {

struct Places {
  cv::Mat columns;
  cv::Mat rows;
};

// Positions in a rotated and magnified source, some of them outside.
Places turned(cv::Size size, cv::Size source, float turn = 0.06f) {
  Places places{cv::Mat(size, CV_32F), cv::Mat(size, CV_32F)};
  for (int v = 0; v < size.height; ++v) {
    for (int u = 0; u < size.width; ++u) {
      const auto along = static_cast<float>(u) / static_cast<float>(size.width - 1);
      const auto down = static_cast<float>(v) / static_cast<float>(size.height - 1);
      const auto width = static_cast<float>(source.width), height = static_cast<float>(source.height);
      places.columns.at<float>(v, u) = (1.1f * along - 0.05f + 1.2f * turn * down) * width;
      places.rows.at<float>(v, u) = (1.1f * down - 0.05f - turn * along) * height;
    }
  }
  return places;
}

TEST(Remap, MatchesOpencv) {
  for (const cv::Size source :
       {cv::Size(160, 120), cv::Size(24, 300), cv::Size(33, 7), cv::Size(2, 2), cv::Size(3, 2)}) {
    for (const cv::Size size : {source, cv::Size(101, 57)}) {
      // From almost no rotation to a large one, with sources of one row in many rows.
      for (const float turn : {0.0f, 0.06f, 0.3f, 0.6f, 2.0f}) {
        const cv::Mat image = white_noise(source, 5);
        const Places places = turned(size, source, turn);
        cv::Mat made, expected, whole, fraction;
        Remap(places.columns, places.rows, source).apply(image, made);
        cv::convertMaps(places.columns, places.rows, whole, fraction, CV_16SC2);
        cv::remap(image, expected, whole, fraction, cv::INTER_LINEAR, cv::BORDER_REPLICATE);
        EXPECT_EQ(cv::countNonZero(made != expected), 0) << source << " to " << size << ", turned by " << turn;
      }
    }
  }
}

TEST(Remap, ReturnsTheSourceRowOfAPixel) {
  const cv::Size size(80, 60);
  for (const float turn : {0.06f, 0.4f, 2.0f}) {
    const Places places = turned(size, size, turn);
    const Remap remap(places.columns, places.rows, size);
    for (int u = 0; u < size.width; ++u) {
      const float row = std::clamp(places.rows.at<float>(30, u), 0.0f, 59.0f);
      EXPECT_NEAR(static_cast<float>(remap.source_row({u, 30})), std::floor(row + 1.0f / 64.0f), 1e-6) << turn;
    }
    EXPECT_EQ(remap.source_row({79, 0}), 0) << "above the image";
  }
}

}  // namespace
}  // namespace byre
