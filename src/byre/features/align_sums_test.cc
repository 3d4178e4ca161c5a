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

// A template without its mean, and the image around where it is laid.
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

TEST_P(AlignSumsOf, AreThoseOfTheDefinition) {
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

TEST_P(AlignSumsOf, AreTheSameToTheLastBitWithEveryInstructionSet) {
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

INSTANTIATE_TEST_SUITE_P(Sizes, AlignSumsOf, testing::Values(8, 10));

TEST(InterpolatedSquare, LiesBetweenThePixels) {
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
