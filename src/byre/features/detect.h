#pragma once

#include "byre/features/fast_corners.h"

#include <vector>

#include <opencv2/core.hpp>

namespace byre {

struct DetectOptions {
  int fast_threshold = 20;     // grey values
  int min_fast_threshold = 7;  // used in cells that give less than their share of corners at fast_threshold
  int cell_size = 64;          // octave pixels: of the cells that are looked at again
  int border = 19;             // octave pixels kept free of corners
};

// FAST-9 corners (Rosten 2006) of one octave, at most max_corners, spread evenly: the image is divided into about as
// many squares as corners are wanted, each gives its strongest, then its second, until there are enough. Ordered by row
// of squares; the same image gives the same corners.
std::vector<Corner> detect_corners(const cv::Mat& level, int max_corners, const DetectOptions& options);

// The same; refills `corners`.
void detect_corners(const cv::Mat& level, int max_corners, const DetectOptions& options, std::vector<Corner>& corners);

}  // namespace byre
