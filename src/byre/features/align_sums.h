#pragma once

#include <cstddef>
#include <cstdint>

namespace byre {

// Length of an array for so many numbers, with zeros after them until whole vectors are full.
constexpr std::size_t padded(int count) {
  constexpr int kLanes = 8;
  return static_cast<std::size_t>((count + kLanes - 1) / kLanes * kLanes);
}

// What a step of aligning a template needs of grey values and their slopes x and y, each without its mean; residuals
// are what the template, at the best gain of the light, leaves of the grey values.
struct AlignSums {
  float xx = 0.0f, xy = 0.0f, yy = 0.0f;  // products of slopes
  float x_residual = 0.0f, y_residual = 0.0f;
  float residual_squares = 0.0f;
  float product = 0.0f;  // grey values times the template
  float squares = 0.0f;  // grey values squared
};

// The template has no mean, and padded(size * size) values; around are the image's (size + 2)^2, row by row. The same
// to the last bit on every processor. Precondition: the size is 8 or 10.
AlignSums align_sums(const float* centred_template, float sum_of_squares, const float* around, int size);

// Takes the mean out of the first size x size of padded(size * size) values, of which those after them are zero and
// stay so. Returns the sum of their squares then; the same to the last bit on every processor. Precondition: the size
// is 8 or 10.
float centre_template(float* values, int size);

// A place in an image and the steps to the next one in a row, and in a column.
struct WarpedPlaces {
  float x = 0.0f, y = 0.0f;
  float x_along_row = 0.0f, y_along_row = 0.0f;
  float x_along_column = 0.0f, y_along_column = 0.0f;
};

// Refills 8 x 8 values of an image of 16 x 16 pixels, interpolated at the places; the same to the last bit on every
// processor. Precondition: a pixel lies to the right of and below each place, or on it.
void warp_square(const std::uint8_t* pixels, const WarpedPlaces& places, float* values);

// Refills size x size values, interpolated between pixels: so far right of and below the pixels from the first one on.
// Precondition: the size is 8 to 16; a row and a column more than that can be read.
void interpolate_square(const std::uint8_t* pixels, std::ptrdiff_t stride, float right, float below, int size,
                        float* values);

}  // namespace byre
