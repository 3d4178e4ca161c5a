#pragma once

#include "byre/features/image.h"

#include <cstdint>
#include <string_view>

namespace byre {

// How usable an image is, whatever it shows. Grey values run from 0 to 255.
struct ImageCondition {
  float brightness = 0.0f;  // mean grey value
  float contrast = 0.0f;    // standard deviation, grey values
  float clipped = 0.0f;     // share of pixels that are black or white beyond measure
  float sharpness = 0.0f;   // steepest hundredth of gradients over contrast, per pixel: falls with blur, not with light
};

// Measured on a regular sample of the pixels, in a tenth of a millisecond for 752 x 480.
ImageCondition measure_condition(const Image& image);

// Why an image is of no use; none when it may be.
enum class ImageFault : std::uint8_t { none, dark, overexposed, flat, blurred };

std::string_view to_string(ImageFault fault);

struct ImageConditionOptions {
  float min_brightness = 8.0f;    // grey values
  float max_brightness = 247.0f;  // grey values
  float min_contrast = 4.0f;      // grey values
  float min_sharpness = 0.15f;    // per pixel
};

// The first fault found, in the order of ImageFault.
ImageFault fault_of(const ImageCondition& condition, const ImageConditionOptions& options);

}  // namespace byre
