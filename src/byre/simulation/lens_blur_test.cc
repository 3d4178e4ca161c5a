#include "byre/simulation/camera_imperfection.h"

#include <numeric>

#include <gmock/gmock.h>

namespace byre {
namespace {

using ::testing::Each;
using ::testing::FloatNear;

constexpr int kWidth = 160;
constexpr int kHeight = 120;

std::vector<float> even(float value) {
  return std::vector<float>(static_cast<std::size_t>(kWidth * kHeight), value);
}

std::size_t index(int column, int row) {
  return static_cast<std::size_t>(row * kWidth + column);
}

// Variance along u of the blur of a single bright pixel.
double variance_of_a_dot(const LensBlur& blur, int column, int row) {
  std::vector<float> image = even(0.0f);
  image[index(column, row)] = 1.0f;
  const std::vector<float> blurred = blur.blurred(image, 1);
  double sum = 0.0, squares = 0.0;
  for (int v = 0; v < kHeight; ++v) {
    for (int u = 0; u < kWidth; ++u) {
      const double light = static_cast<double>(blurred[index(u, v)]);
      sum += light;
      squares += light * (u - column) * (u - column);
    }
  }
  return squares / sum;
}

TEST(LensBlur, OfZeroLeavesTheImage) {
  const LensBlur blur(kWidth, kHeight, {});
  std::vector<float> image = even(0.0f);
  std::iota(image.begin(), image.end(), 0.0f);
  EXPECT_TRUE(blur.is_sharp());
  EXPECT_EQ(blur.blurred(image, 1), image);
}

TEST(LensBlur, SpreadsADotByItsSigma) {
  for (const float corner : {0.4f, 1.0f, 2.0f}) {
    const LensBlur blur(kWidth, kHeight, {corner});
    for (const int column : {20, 60, 140}) {
      const double sigma = static_cast<double>(blur.sigma_at(column, 100));
      EXPECT_NEAR(variance_of_a_dot(blur, column, 100), sigma * sigma, 0.1 * sigma * sigma) << corner << " " << column;
    }
  }
}

TEST(LensBlur, GrowsQuadraticallyFromTheSharpestPosition) {
  const LensBlur blur(kWidth, kHeight, {1.0f});
  EXPECT_NEAR(blur.sigma_at(0, 0), 1.0f, 0.03f);
  EXPECT_NEAR(blur.sigma_at(kWidth / 4, kHeight / 4), 0.25f, 0.02f);
  EXPECT_LT(blur.sigma_at(kWidth / 2, kHeight / 2), 0.001f);
  const LensBlur aside(kWidth, kHeight, {1.0f, {0.1f, -0.05f}});
  EXPECT_LT(aside.sigma_at(kWidth / 2 + 16, kHeight / 2 - 8), 0.001f);
  EXPECT_GT(aside.sigma_at(0, kHeight - 1), 1.2f);
}

TEST(LensBlur, KeepsUniformLightUpToTheBorder) {
  EXPECT_THAT(LensBlur(kWidth, kHeight, {2.0f}).blurred(even(0.7f), 1), Each(FloatNear(0.7f, 1e-5f)));
}

TEST(LensBlur, IsIndependentOfTheNumberOfThreads) {
  const LensBlur blur(kWidth, kHeight, {1.5f});
  std::vector<float> image = even(0.0f);
  for (std::size_t i = 0; i < image.size(); ++i) image[i] = static_cast<float>(i * i % 251);
  EXPECT_EQ(blur.blurred(image, 1), blur.blurred(image, 3));
}

}  // namespace
}  // namespace byre
