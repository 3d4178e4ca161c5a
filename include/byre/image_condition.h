#pragma once

#include "byre/image.h"

#include <cstdint>
#include <string_view>

namespace byre {

// How usable an image is, whatever it shows. Grey values run from 0 to 255.
struct ImageCondition {
  float brightness = 0.0f;  // mean grey value
  float contrast = 0.0f;    // grey values by which pixels 16 apart differ, over the root of two; noise is left out
  float clipped = 0.0f;     // share of pixels that are black or white beyond measure
  // How much of the difference between pixels 16 apart is there 2 apart already, in the direction in which it is least:
  // 1 for sharp edges, falls with the square of the length of blur. Exposure does not change it; noise and fine texture
  // raise it.
  float sharpness = 0.0f;
  float noise = 0.0f;  // grey values, standard deviation from pixel to pixel; fine texture everywhere raises it
};

// Measured on every eighth row, of an image as the camera gave it: rectifying it takes a fifth of the sharpness of
// sharp images, and less of that of blurred ones. Of an image smaller than 33 x 17 only brightness and clipped are
// known.
ImageCondition measure_condition(const Image& image);

// Why an image is of no use; none when it may be.
enum class ImageFault : std::uint8_t { none, dark, overexposed, flat, blurred };

std::string_view to_string(ImageFault fault);

// Nothing that is still tracked is a fault: docs/mission_tests.md has the distributions that these lie outside of.
struct ImageConditionOptions {
  float min_brightness = 8.0f;    // grey values
  float max_brightness = 247.0f;  // grey values
  float min_contrast = 1.5f;      // grey values
  float min_sharpness = 0.23f;
};

// The first fault found, in the order of ImageFault.
ImageFault fault_of(const ImageCondition& condition, const ImageConditionOptions& options);

}  // namespace byre
