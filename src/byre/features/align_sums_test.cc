#include "byre/features/align_sums.h"

#include <algorithm>
#include <numeric>
#include <random>
#include <vector>

#include <gtest/gtest.h>
#include <hwy/targets.h>

namespace byre {
namespace {

std::vector<float> drawn_greys(int count) {
  std::mt19937 random(5);
  std::uniform_real_distribution<float> grey(0.0f, 255.0f);
  std::vector<float> values(static_cast<std::size_t>(count));
  std::ranges::generate(values, [&] { return grey(random); });
  return values;
}

std::vector<double> without_mean(std::vector<double> values) {
  const double mean = std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
  for (double& value : values) value -= mean;
  return values;
}

double dot(const std::vector<double>& a, const std::vector<double>& b) {
  return std::inner_product(a.begin(), a.end(), b.begin(), 0.0);
}

// A template with zero mean, and the image around it.
struct Square {
  explicit Square(int side)
      : size(side), around(drawn_greys((side + 2) * (side + 2))), reference(padded(side * side), 0.0f) {
    const std::vector<float> drawn = drawn_greys(side * side);
    std::vector<double> grey(drawn.rbegin(), drawn.rend());
    grey = without_mean(grey);
    std::ranges::transform(grey, reference.begin(), [](double value) { return static_cast<float>(value); });
    squares = static_cast<float>(dot(grey, grey));
  }
  AlignSums sums() const { return align_sums(reference.data(), squares, around.data(), size); }

  int size;
  std::vector<float> around;
  std::vector<float> reference;
  float squares = 0.0f;
};

class AlignSumsOf : public testing::TestWithParam<int> {};

TEST_P(AlignSumsOf, MatchTheDefinition) {
  const Square square(GetParam());
  const int stride = square.size + 2;
  std::vector<double> grey, x, y, expected, residual;
  for (int row = 1; row <= square.size; ++row) {
    for (int column = 1; column <= square.size; ++column) {
      const auto at = [&](int r, int c) {
        return static_cast<double>(square.around[static_cast<std::size_t>(r * stride + c)]);
      };
      grey.push_back(at(row, column));
      x.push_back(0.5 * (at(row, column + 1) - at(row, column - 1)));
      y.push_back(0.5 * (at(row + 1, column) - at(row - 1, column)));
    }
  }
  expected.assign(square.reference.begin(), square.reference.begin() + square.size * square.size);
  grey = without_mean(grey);
  x = without_mean(x);
  y = without_mean(y);
  const double gain = dot(grey, expected) / static_cast<double>(square.squares);
  for (std::size_t i = 0; i < grey.size(); ++i) residual.push_back(grey[i] - gain * expected[i]);
  const double tolerance = 1e-5 * dot(grey, grey);
  const AlignSums sums = square.sums();
  EXPECT_NEAR(sums.product, dot(grey, expected), tolerance);
  EXPECT_NEAR(sums.squares, dot(grey, grey), tolerance);
  EXPECT_NEAR(sums.xx, dot(x, x), tolerance);
  EXPECT_NEAR(sums.xy, dot(x, y), tolerance);
  EXPECT_NEAR(sums.yy, dot(y, y), tolerance);
  EXPECT_NEAR(sums.x_residual, dot(x, residual), tolerance);
  EXPECT_NEAR(sums.y_residual, dot(y, residual), tolerance);
  EXPECT_NEAR(sums.residual_squares, dot(residual, residual), tolerance);
}

TEST_P(AlignSumsOf, AreBitIdenticalForEveryInstructionSet) {
  const Square square(GetParam());
  const AlignSums usual = square.sums();
  for (const auto target : hwy::SupportedAndGeneratedTargets()) {
    hwy::SetSupportedTargetsForTest(target);
    const AlignSums sums = square.sums();
    EXPECT_EQ(sums.product, usual.product) << hwy::TargetName(target);
    EXPECT_EQ(sums.xy, usual.xy) << hwy::TargetName(target);
    EXPECT_EQ(sums.x_residual, usual.x_residual) << hwy::TargetName(target);
    EXPECT_EQ(sums.residual_squares, usual.residual_squares) << hwy::TargetName(target);
  }
  hwy::SetSupportedTargetsForTest(0);
}

TEST_P(AlignSumsOf, SubtractTheMeanOfTheTemplate) {
  const int count = GetParam() * GetParam();
  const std::vector<float> drawn = drawn_greys(count);
  std::vector<float> values = drawn;
  values.resize(padded(count), 0.0f);
  const float squares = centre_template(values.data(), GetParam());
  const std::vector<double> expected = without_mean({drawn.begin(), drawn.end()});
  for (std::size_t i = 0; i < expected.size(); ++i) EXPECT_NEAR(values[i], expected[i], 1e-3);
  EXPECT_NEAR(squares, dot(expected, expected), 1e-5 * dot(expected, expected));
  for (const auto target : hwy::SupportedAndGeneratedTargets()) {
    hwy::SetSupportedTargetsForTest(target);
    std::vector<float> again = drawn;
    again.resize(padded(count), 0.0f);
    EXPECT_EQ(centre_template(again.data(), GetParam()), squares) << hwy::TargetName(target);
    EXPECT_EQ(again, values) << hwy::TargetName(target);
  }
  hwy::SetSupportedTargetsForTest(0);
}

INSTANTIATE_TEST_SUITE_P(Sizes, AlignSumsOf, testing::Values(8, 10));

double value_between(const std::vector<std::uint8_t>& pixels, int stride, double x, double y) {
  const int column = static_cast<int>(x), row = static_cast<int>(y);
  const double right = x - column, below = y - row;
  const auto at = [&](int u, int v) { return static_cast<double>(pixels[static_cast<std::size_t>(v * stride + u)]); };
  const double upper = (1.0 - right) * at(column, row) + right * at(column + 1, row);
  return (1.0 - below) * upper + below * ((1.0 - right) * at(column, row + 1) + right * at(column + 1, row + 1));
}

TEST(WarpedSquare, InterpolatesBetweenPixels) {
  constexpr int kSide = 16;
  std::vector<std::uint8_t> pixels(kSide * kSide);
  for (std::size_t i = 0; i < pixels.size(); ++i) pixels[i] = static_cast<std::uint8_t>(i * i % 251);
  for (const WarpGrid& places :
       {WarpGrid{3.25f, 4.7f, 1.0f, 0.0f, 0.0f, 1.0f}, WarpGrid{4.0f, 6.5f, 1.1f, -0.3f, 0.25f, 0.9f},
        WarpGrid{0.01f, 14.98f, 2.13f, 0.0f, 0.0f, -2.13f}}) {
    std::vector<float> values(64), again(64);
    warp_square(pixels.data(), places, values.data());
    for (int row = 0; row < 8; ++row) {
      for (int column = 0; column < 8; ++column) {
        const double x = places.x + column * places.x_along_row + row * places.x_along_column;
        const double y = places.y + column * places.y_along_row + row * places.y_along_column;
        EXPECT_NEAR(values[static_cast<std::size_t>(8 * row + column)], value_between(pixels, kSide, x, y), 2e-3);
      }
    }
    for (const auto target : hwy::SupportedAndGeneratedTargets()) {
      hwy::SetSupportedTargetsForTest(target);
      warp_square(pixels.data(), places, again.data());
      EXPECT_EQ(again, values) << hwy::TargetName(target);
    }
    hwy::SetSupportedTargetsForTest(0);
  }
}

TEST(InterpolatedSquare, InterpolatesBetweenPixels) {
  constexpr int kStride = 20;
  std::vector<std::uint8_t> pixels(kStride * kStride);
  for (std::size_t i = 0; i < pixels.size(); ++i) pixels[i] = static_cast<std::uint8_t>(i * i % 251);
  for (const int size : {8, 10, 12, 16}) {
    std::vector<float> values(static_cast<std::size_t>(size * size));
    interpolate_square(pixels.data() + kStride + 1, kStride, 0.25f, 0.7f, size, values.data());
    for (int row = 0; row < size; ++row) {
      for (int column = 0; column < size; ++column) {
        const std::uint8_t* const at = pixels.data() + (row + 1) * kStride + column + 1;
        const double upper = 0.75 * at[0] + 0.25 * at[1], lower = 0.75 * at[kStride] + 0.25 * at[kStride + 1];
        EXPECT_NEAR(values[static_cast<std::size_t>(row * size + column)], 0.3 * upper + 0.7 * lower, 1e-3);
      }
    }
  }
}

}  // namespace
}  // namespace byre
