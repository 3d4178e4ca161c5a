#include "byre/simulation/surface_texture.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <vector>

#include <gmock/gmock.h>

namespace byre {
namespace {

// Greys at every millimetre along a line.
std::vector<float> greys_along_a_line(std::uint64_t seed, float footprint) {
  std::vector<float> greys;
  for (int i = 0; i < 4000; ++i) {
    greys.push_back(surface_grey(seed, {-2.0f + 0.001f * static_cast<float>(i), 0.37f, footprint}));
  }
  return greys;
}

float largest_step(const std::vector<float>& greys) {
  float largest = 0.0f;
  for (std::size_t i = 1; i < greys.size(); ++i) largest = std::max(largest, std::abs(greys[i] - greys[i - 1]));
  return largest;
}

TEST(SurfaceGrey, UsesManyGreyValuesInRange) {
  const std::vector<float> greys = greys_along_a_line(1, 0.005f);
  EXPECT_THAT(greys, ::testing::Each(::testing::AllOf(::testing::Ge(0.0f), ::testing::Le(255.0f))));
  const auto [darkest, brightest] = std::ranges::minmax(greys);
  EXPECT_GT(brightest - darkest, 120.0f);
}

TEST(SurfaceGrey, ChangesOverAFootprint) {
  EXPECT_GT(largest_step(greys_along_a_line(1, 0.001f)), 60.0f) << "edges are sharp at a small distance";
  EXPECT_LT(largest_step(greys_along_a_line(1, 0.020f)), 20.0f) << "edges are blurred at a large distance";
}

TEST(SurfaceGrey, LosesDetailWithDistance) {
  const auto roughness = [](const std::vector<float>& greys) {
    float sum = 0.0f;
    for (std::size_t i = 30; i < greys.size(); i += 30) sum += std::abs(greys[i] - greys[i - 30]);
    return sum;
  };
  EXPECT_LT(roughness(greys_along_a_line(1, 0.2f)), 0.5f * roughness(greys_along_a_line(1, 0.002f)));
}

TEST(SurfaceGrey, DiffersBetweenSurfaces) {
  EXPECT_EQ(greys_along_a_line(1, 0.005f), greys_along_a_line(1, 0.005f));
  EXPECT_NE(greys_along_a_line(1, 0.005f), greys_along_a_line(2, 0.005f));
}

TEST(Hash, FlipsHalfTheBitsForNeighbours) {
  int flipped = 0;
  for (std::uint64_t i = 0; i < 1000; ++i) {
    flipped += std::popcount(hash(7, i, 3) ^ hash(7, i + 1, 3)) + std::popcount(hash(7, 3, i) ^ hash(7, 3, i + 1));
  }
  EXPECT_NEAR(flipped / 2000.0, 32.0, 0.5);
}

}  // namespace
}  // namespace byre
