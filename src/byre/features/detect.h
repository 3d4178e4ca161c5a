#pragma once

#include "byre/features/fast_corners.h"

#include <opencv2/core.hpp>

namespace byre {

struct DetectOptions {
  int fast_threshold = 20;     // grey values
  int min_fast_threshold = 7;  // used in cells with less than their share of corners at fast_threshold
  int cell_size = 64;          // octave pixels; cells of the second search
  int border = 19;             // octave pixels kept free of corners
};

// FAST-9 corners (Rosten 2006) of one octave, at most max_corners, evenly distributed: the image is divided into about
// max_corners squares; each contributes its strongest corner, then its second, until there are enough. Ordered by row
// of squares. Deterministic. strengths: working memory.
ScratchVector<Corner> detect_corners(const cv::Mat& level, int max_corners, const DetectOptions& options,
                                     cv::Mat& strengths);

}  // namespace byre
