#pragma once

#include "byre/image.h"

#include <cstdint>
#include <string_view>

namespace byre {

// Exposure and focus of an image, independent of its content. Grey values are 0 to 255.
struct ImageCondition {
  float brightness = 0.0f;  // mean grey value
  float contrast = 0.0f;    // RMS grey-value difference of pixels 16 apart, over the root of two, corrected for noise
  float clipped = 0.0f;     // share of black (up to 2) or white (from 253) pixels
  // Mean squared difference per distance of pixels 2 apart, relative to pixels 16 apart, in the direction of the least
  // ratio: 1 for sharp edges, falls with the square of the blur length. Independent of exposure; raised by noise and
  // fine texture.
  float sharpness = 0.0f;
  float noise = 0.0f;  // standard deviation between neighbouring pixels, grey values; dense fine texture raises it
};

// Uses every eighth row of an unrectified image: rectification reduces the sharpness of sharp images by a fifth, that
// of blurred ones by less. Images of at most 32 x 16 pixels yield brightness and clipped only.
ImageCondition measure_condition(const Image& image);

// Reason why an image is unusable.
enum class ImageFault : std::uint8_t { none, dark, overexposed, flat, blurred };

std::string_view to_string(ImageFault fault);

// Thresholds beyond the distributions of images that are still tracked; docs/lab/mission_tests.md has the
// distributions.
struct ImageConditionOptions {
  float min_brightness = 8.0f;    // grey values
  float max_brightness = 247.0f;  // grey values
  float min_contrast = 1.5f;      // grey values
  float min_sharpness = 0.23f;
};

// First fault in the order of ImageFault.
ImageFault fault_of(const ImageCondition& condition, const ImageConditionOptions& options);

}  // namespace byre
