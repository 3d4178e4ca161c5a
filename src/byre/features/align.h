#pragma once

#include "byre/features.h"

#include <optional>

namespace byre {

struct AlignOptions {
  int max_iterations = 8;
  float max_shift = 3.0f;        // octave pixels from the start
  float min_similarity = 0.80f;  // zero-mean normalised cross-correlation
  float min_sigma = 0.06f;       // octave pixels: a patch is never trusted beyond this
};

struct Alignment {
  Eigen::Vector2f pixel;    // place of the reference pixel in the current patch, octave pixels
  float sigma = 0.0f;       // octave pixels, the larger axis of its covariance
  float similarity = 0.0f;  // zero-mean normalised cross-correlation, at most 1
};

// Finds the pixel of the reference patch in the current one to a fraction of a pixel, by Gauss-Newton on the grey
// values of an 8x8 template (Lucas and Kanade 1981) with gain and offset of the light taken out.
// reference_from_current warps small offsets, octave pixels to octave pixels. Empty when the template leaves either
// patch, the iteration does not settle, or the two do not look alike.
std::optional<Alignment> align_patches(const Patch& reference, const Eigen::Vector2f& reference_pixel,
                                       const Patch& current, const Eigen::Matrix2f& reference_from_current,
                                       const Eigen::Vector2f& start, const AlignOptions& options);

}  // namespace byre
