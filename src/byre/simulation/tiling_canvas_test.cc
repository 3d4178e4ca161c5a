#include "byre/simulation/tiling_canvas.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <gmock/gmock.h>

namespace byre {
namespace {

using ::testing::Each;
using ::testing::FloatNear;

constexpr int kCanvasSize = 32;

float texel(const TilingCanvas& canvas, int column, int row) {
  return canvas.texels()[static_cast<std::size_t>(row * kCanvasSize + column)];
}

TEST(TilingCanvas, DrawsAStrokeOfTheGivenLengthAndWidth) {
  TilingCanvas canvas(kCanvasSize, 0.0f);
  canvas.draw({.x = 4.0f, .y = 10.0f, .direction = 0.0f, .length = 12.0f, .width = 3.0f, .reflectance = 1.0f});
  EXPECT_EQ(texel(canvas, 8, 10), 1.0f);
  EXPECT_EQ(texel(canvas, 8, 11), 1.0f);
  EXPECT_EQ(texel(canvas, 8, 14), 0.0f);
  EXPECT_EQ(texel(canvas, 2, 10), 0.0f);
  EXPECT_EQ(texel(canvas, 18, 10), 0.0f);
}

TEST(TilingCanvas, ContinuesAStrokeOnTheOppositeSide) {
  TilingCanvas canvas(kCanvasSize, 0.0f);
  constexpr float kUp = 0.5f * std::numbers::pi_v<float>;
  canvas.draw({.x = 5.0f, .y = 28.0f, .direction = kUp, .length = 10.0f, .width = 1.0f, .reflectance = 1.0f});
  EXPECT_NEAR(texel(canvas, 5, 30), 1.0f, 1e-4f);
  EXPECT_NEAR(texel(canvas, 5, 4), 1.0f, 1e-4f);
  EXPECT_EQ(texel(canvas, 5, 12), 0.0f);
}

TEST(TilingCanvas, FillsEachTexel) {
  TilingCanvas canvas(kCanvasSize, 0.25f);
  canvas.fill([](int, int, float before) { return before + 0.5f; });
  EXPECT_THAT(canvas.texels(), Each(FloatNear(0.75f, 1e-6f)));
}

TEST(TilingNoise, IsContinuousAcrossTheBorder) {
  const std::vector<float> noise = tiling_noise(kCanvasSize, 4, 4, 1, 7);
  const auto at = [&](int column, int row) { return noise[static_cast<std::size_t>(row * kCanvasSize + column)]; };
  float largest_step = 0.0f;
  for (int i = 0; i < kCanvasSize; ++i) {
    for (int j = 0; j + 1 < kCanvasSize; ++j) largest_step = std::max(largest_step, std::abs(at(j, i) - at(j + 1, i)));
  }
  for (int i = 0; i < kCanvasSize; ++i) {
    EXPECT_LE(std::abs(at(kCanvasSize - 1, i) - at(0, i)), 1.5f * largest_step);
    EXPECT_LE(std::abs(at(i, kCanvasSize - 1) - at(i, 0)), 1.5f * largest_step);
  }
  EXPECT_GT(*std::ranges::max_element(noise) - *std::ranges::min_element(noise), 0.5f);
}

}  // namespace
}  // namespace byre
