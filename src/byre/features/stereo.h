#pragma once

#include "byre/features/pyramid.h"

#include <optional>
#include <span>

namespace byre {

struct StereoOptions {
  double min_depth = 0.3;           // metres; nearer points are not searched
  double max_width_share = 0.25;    // largest disparity as a share of the image's width
  float max_ratio = 0.85f;          // best over second best sum of absolute differences on the row
  float max_vertical_error = 1.2f;  // octave pixels, largest row error of the rectification
  float min_similarity = 0.85f;     // similarity of the refined match, see Alignment
  float min_sigma = 0.08f;          // octave pixels
};

struct StereoMatch {
  float disparity = 0.0f;   // full-resolution pixels
  float sigma = 0.0f;       // full-resolution pixels
  float row_offset = 0.0f;  // right row minus left row, full-resolution pixels
};

// Matches each keypoint in the right image: searches its row by the sum of absolute differences, requires a unique and
// mutual best match, and refines it to sub-pixel accuracy. `matches` has one entry per keypoint, set to empty if
// unmatched. Keypoints are on whole octave pixels. Pyramids are those of a rectified pair.
void match_stereo(const Pyramid& left, const Pyramid& right, const Rig& rig, std::span<const Keypoint> keypoints,
                  const StereoOptions& options, std::span<std::optional<StereoMatch>> matches);

}  // namespace byre
