#include "byre/io/image/image_file.h"

#include <gtest/gtest.h>

namespace byre {
namespace {

// Grey values increase to the right and are constant in a column.
Image ramp(int width, int height) {
  Image image{width, height, {}};
  for (int row = 0; row < height; ++row) {
    for (int column = 0; column < width; ++column) image.pixels.push_back(static_cast<std::uint8_t>(column * 2));
  }
  return image;
}

TEST(Fit, KeepsAnImageThatFits) {
  EXPECT_EQ(resize_to_cover(ramp(40, 30), 40, 30).pixels, ramp(40, 30).pixels);
}

TEST(Fit, CropsToTheCentre) {
  const Image middle = resize_to_cover(ramp(60, 20), 20, 20);
  EXPECT_EQ(middle.width, 20);
  EXPECT_EQ(middle.height, 20);
  EXPECT_EQ(middle.pixels.front(), 40);
  EXPECT_EQ(middle.pixels.back(), 78);
}

TEST(Fit, ScalesToCover) {
  const Image half = resize_to_cover(ramp(80, 60), 40, 30);
  EXPECT_EQ(half.pixels.size(), 1200u);
  EXPECT_NEAR(half.pixels[20], 81, 1);  // the mean of columns 40 and 41
}

}  // namespace
}  // namespace byre
