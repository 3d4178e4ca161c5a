#pragma once

#include "byre/base/scratch_memory.h"

#include <opencv2/core.hpp>

namespace byre {

struct Corner {
  int x = 0;  // octave pixels
  int y = 0;
  float response = 0.0f;  // grey values, highest threshold at which it is a corner
};

// Radius of the circle of pixels compared with a FAST corner.
inline constexpr int kFastRadius = 3;

// Refills `strengths` (8 bit, sized like the image) with FAST-9 strengths in grey values (Rosten 2006): the largest
// difference by which nine contiguous pixels on the circle of sixteen are all brighter, or all darker. A pixel is a
// corner at each threshold below its strength. Strengths up to the threshold, and outside the area, are 0.
// Precondition: the area keeps kFastRadius from the image's border.
void measure_fast_strengths(const cv::Mat& image, const cv::Rect& area, int threshold, cv::Mat& strengths);

// Appends the pixels of the area that are stronger than the threshold and than each of their eight neighbours, row by
// row. Precondition: the area keeps one pixel from the border.
void append_peaks(const cv::Mat& strengths, const cv::Rect& area, int threshold, ScratchVector<Corner>& corners);

}  // namespace byre
