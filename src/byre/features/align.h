#pragma once

#include "byre/features.h"

#include <optional>

namespace byre {

struct AlignOptions {
  int max_iterations = 8;
  float max_shift = 3.0f;        // octave pixels from the start
  float min_similarity = 0.80f;  // zero-mean normalised cross-correlation
  float min_sigma = 0.06f;       // octave pixels; lower bound of sigma
};

struct Alignment {
  Eigen::Vector2f pixel;    // position of the reference pixel in the current patch, octave pixels
  float sigma = 0.0f;       // octave pixels, standard deviation along the worse axis
  float similarity = 0.0f;  // zero-mean normalised cross-correlation, at most 1
};

// Aligns the reference patch with the current one to a fraction of a pixel: Gauss-Newton on an 8x8 template (Lucas and
// Kanade 1981), with gain and offset of the brightness eliminated. reference_from_current warps small offsets, octave
// pixels to octave pixels. Empty if the template leaves either patch, the iteration does not converge, or the
// similarity is too low.
std::optional<Alignment> align_patches(const Patch& reference, const Eigen::Vector2f& reference_pixel,
                                       const Patch& current, const Eigen::Matrix2f& reference_from_current,
                                       const Eigen::Vector2f& start, const AlignOptions& options);

}  // namespace byre
