#pragma once

#include <cstddef>
#include <cstdint>

namespace byre {

// Array length for `count` numbers, rounded up to whole vectors. The rest is zero.
constexpr std::size_t padded(int count) {
  constexpr int kLanes = 8;
  return static_cast<std::size_t>((count + kLanes - 1) / kLanes * kLanes);
}

// Sums of a Gauss-Newton step over grey values and their gradients x and y, each with its mean removed. Residuals: grey
// values minus the template at the best gain.
struct AlignSums {
  float xx = 0.0f, xy = 0.0f, yy = 0.0f;  // products of gradients
  float x_residual = 0.0f, y_residual = 0.0f;
  float residual_squares = 0.0f;
  float product = 0.0f;  // grey values times the template
  float squares = 0.0f;  // grey values squared
};

// The template has zero mean, and padded(size * size) values. around: (size + 2)^2 grey values, row by row.
// Bit-identical on all processors. Precondition: the size is 8 or 10.
AlignSums align_sums(const float* centred_template, float sum_of_squares, const float* around, int size);

// Subtracts the mean from the first size x size of padded(size * size) values; the others are zero and stay zero.
// Returns the sum of squares of the result. Bit-identical on all processors. Precondition: the size is 8 or 10.
float centre_template(float* values, int size);

// A position in an image, and the steps to the next position in a row and in a column.
struct WarpGrid {
  float x = 0.0f, y = 0.0f;
  float x_along_row = 0.0f, y_along_row = 0.0f;
  float x_along_column = 0.0f, y_along_column = 0.0f;
};

// Fills 8 x 8 values of an image of 16 x 16 pixels, interpolated at the positions. Bit-identical on all processors.
// Precondition: each position has a pixel to the right and below, or is on a pixel.
void warp_square(const std::uint8_t* pixels, const WarpGrid& places, float* values);

// Fills size x size values, interpolated at the offset (right, below) in pixels from each pixel, starting at the first.
// Preconditions: the size is 8 to 16; one more row and column are readable.
void interpolate_square(const std::uint8_t* pixels, std::ptrdiff_t stride, float right, float below, int size,
                        float* values);

}  // namespace byre
