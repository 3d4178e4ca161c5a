#include "byre/camera/camera_measure.h"

#include <gmock/gmock.h>

namespace byre {
namespace {

using std::chrono_literals::operator""ms;

// White dots on black, only in the right half.
Image half_full() {
  Image image{320, 240, std::vector<std::uint8_t>(320 * 240)};
  for (int y = 0; y < 240; ++y) {
    for (int x = 160; x < 320; ++x) {
      if (x % 10 == 5 && y % 10 == 5) image.pixels[static_cast<std::size_t>(y * 320 + x)] = 255;
    }
  }
  return image;
}

TEST(CornerGrid, CountsCornersPerCell) {
  const CornerGrid grid = count_corners(half_full());
  EXPECT_GT(grid.total(), 100);
  EXPECT_EQ(grid.empty_cells(), 24) << "the left half of the image";
  EXPECT_EQ(grid.corners[0], 0);
  EXPECT_GT(grid.corners[CornerGrid::kColumns - 1], 3);
}

TEST(CornerGrid, OfATinyImageIsEmpty) {
  EXPECT_EQ(count_corners({4, 4, std::vector<std::uint8_t>(16)}).total(), 0);
}

TEST(StampIntervals, MeasureRateAndJitter) {
  EXPECT_FALSE(measure_intervals({0ms, 50ms}));
  const auto even = measure_intervals({0ms, 50ms, 100ms, 150ms});
  ASSERT_TRUE(even);
  EXPECT_NEAR(even->rate_hz, 20.0, 1e-9);
  EXPECT_NEAR(even->deviation_s, 0.0, 1e-12);
  const auto uneven = measure_intervals({0ms, 40ms, 100ms, 200ms});
  EXPECT_NEAR(uneven->longest_s, 0.1, 1e-12);
  EXPECT_NEAR(uneven->deviation_s, 0.02494, 1e-5);
}

}  // namespace
}  // namespace byre
