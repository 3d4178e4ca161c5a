#include "byre/features/detect.h"

#include "byre/features/image_scene.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace byre {
namespace {

using testing::IsEmpty;
using testing::SizeIs;

constexpr int kPlenty = 100000;

cv::Mat image_of_texture() {
  return render(400, 304, Texture(21));
}

bool same_corner(const Corner& a, const Corner& b) {
  return a.x == b.x && a.y == b.y && a.response == b.response;
}

// Number of corners in each square inside the border.
std::vector<int> count_by_square(std::span<const Corner> corners, const cv::Size& size, int border, int side) {
  const int columns = (size.width - 2 * border) / side;
  const int rows = (size.height - 2 * border) / side;
  std::vector<int> counts(static_cast<std::size_t>(columns * rows), 0);
  for (const Corner& corner : corners) {
    const int column = (corner.x - border) / side;
    const int row = (corner.y - border) / side;
    if (column < columns && row < rows) ++counts[static_cast<std::size_t>(row * columns + column)];
  }
  return counts;
}

TEST(DetectCorners, CoversAllPartsOfATexturedImage) {
  const cv::Mat image = image_of_texture();
  const DetectOptions options;
  const auto corners = detect_corners(image, 500, options);
  const auto counts = count_by_square(corners, image.size(), options.border, 40);
  EXPECT_GE(*std::min_element(counts.begin(), counts.end()), 1);
}

TEST(DetectCorners, SpreadsEvenlyDespiteUnequalContrast) {
  const Texture strong(22, 1.0), weak(23, 0.45);
  const cv::Mat image = render(400, 304, [&](double x, double y) { return x < 200.0 ? strong(x, y) : weak(x, y); });
  const auto corners = detect_corners(image, 200, {});
  const auto left = std::count_if(corners.begin(), corners.end(), [](const Corner& c) { return c.x < 200; });
  EXPECT_THAT(corners, SizeIs(200));
  EXPECT_GE(left, 70);
  EXPECT_LE(left, 130);
}

TEST(DetectCorners, ReturnsAtMostTheWantedNumber) {
  const cv::Mat image = image_of_texture();
  for (const int wanted : {0, 1, 37, 250}) EXPECT_THAT(detect_corners(image, wanted, {}), SizeIs(wanted));
  EXPECT_GT(detect_corners(image, kPlenty, {}).size(), 250u);
}

TEST(DetectCorners, ReturnsTheStrongestOfASquareFirst) {
  const cv::Mat image = image_of_texture();
  const auto all = detect_corners(image, kPlenty, {});
  const auto one = detect_corners(image, 1, {});
  const auto strongest = std::max_element(all.begin(), all.end(),
                                          [](const Corner& a, const Corner& b) { return a.response < b.response; });
  EXPECT_EQ(one.at(0).response, strongest->response);
}

TEST(DetectCorners, ReturnsNoPixelTwice) {
  const auto corners = detect_corners(image_of_texture(), kPlenty, {});
  std::set<std::pair<int, int>> pixels;
  for (const Corner& corner : corners) pixels.insert({corner.x, corner.y});
  EXPECT_EQ(pixels.size(), corners.size());
}

TEST(DetectCorners, ExcludesExactlyTheBorder) {
  const cv::Mat image = image_of_texture();
  for (const int border : {3, 19, 30}) {
    DetectOptions options;
    options.border = border;
    cv::Rect inner(border, border, image.cols - 2 * border, image.rows - 2 * border);
    cv::Rect found;
    for (const Corner& corner : detect_corners(image, kPlenty, options)) {
      EXPECT_TRUE(inner.contains({corner.x, corner.y})) << corner.x << ", " << corner.y;
      found |= cv::Rect(corner.x, corner.y, 1, 1);
    }
    EXPECT_GT(found.width, inner.width - 8);
    EXPECT_GT(found.height, inner.height - 8);
  }
}

TEST(DetectCorners, UsesTheLowThresholdInDullImages) {
  const cv::Mat dull = render(400, 304, Texture(24, 0.25));
  DetectOptions strict;
  strict.min_fast_threshold = strict.fast_threshold;
  const auto strict_count = detect_corners(dull, kPlenty, strict).size();
  const auto corners = detect_corners(dull, kPlenty, {});
  EXPECT_GT(corners.size(), 3 * strict_count + 100);
  const auto counts = count_by_square(corners, dull.size(), 19, 64);
  EXPECT_GE(*std::min_element(counts.begin(), counts.end()), 1);
}

TEST(DetectCorners, KeepsTheHighThresholdInFullCells) {
  // Cells of 32 pixels with a bright spot and a faint one; cells of the first row have no bright one.
  const cv::Mat image = render(230, 230, [](double x, double y) {
    const double u = std::fmod(x - 19.0 + 32.0, 32.0), v = std::fmod(y - 19.0 + 32.0, 32.0);
    const auto spot = [&](double at) { return std::exp(-0.25 * (std::pow(u - at, 2) + std::pow(v - at, 2))); };
    return 100.0 + (y < 19.0 + 32.0 ? 0.0 : 100.0 * spot(8.2)) + 16.0 * spot(24.2);
  });
  DetectOptions options;
  options.cell_size = 32;
  constexpr int kOneForEachCell = 36;
  int bright = 0, faint = 0;
  for (const Corner& corner : detect_corners(image, kOneForEachCell, options)) {
    const bool in_first_row = corner.y < 19 + 32;
    EXPECT_EQ(corner.response < 20.0f, in_first_row) << corner.x << ", " << corner.y;
    ++(in_first_row ? faint : bright);
  }
  EXPECT_EQ(faint, 6);
  EXPECT_EQ(bright, 30);
}

TEST(DetectCorners, IsDeterministic) {
  const cv::Mat image = image_of_texture();
  const auto first = detect_corners(image, 200, {});
  const auto second = detect_corners(image.clone(), 200, {});
  EXPECT_TRUE(std::equal(first.begin(), first.end(), second.begin(), second.end(), same_corner));
}

TEST(DetectCorners, ReturnsNothingForABlankImage) {
  EXPECT_THAT(detect_corners(cv::Mat(200, 200, CV_8U, cv::Scalar(90)), 100, {}), IsEmpty());
}

TEST(DetectCorners, ReturnsNothingIfAllIsBorder) {
  const Texture texture(25);
  for (const int side : {1, 20, 38}) EXPECT_THAT(detect_corners(render(side, side, texture), 100, {}), IsEmpty());
  EXPECT_THAT(detect_corners(render(38, 300, texture), 100, {}), IsEmpty());
  EXPECT_THAT(detect_corners(cv::Mat(), 100, {}), IsEmpty());
}

}  // namespace
}  // namespace byre
