#pragma once

#include <vector>

#include <opencv2/core.hpp>

namespace byre {

struct Corner {
  int x = 0;  // octave pixels
  int y = 0;
  float response = 0.0f;  // highest threshold, grey values, at which it is a corner
};

// Pixels about a FAST corner that are compared with it.
inline constexpr int kFastRadius = 3;

// Refills `strengths` (8 bit, sized like the image): how much nine neighbouring pixels on the circle of sixteen about a
// pixel are all brighter, or all darker, than it is, in grey values (FAST-9, Rosten 2006); 0 up to the threshold. A
// pixel is a corner at each threshold below its strength. 0 outside the area. Precondition: the area keeps kFastRadius
// from the image's border.
void measure_fast_strengths(const cv::Mat& image, const cv::Rect& area, int threshold, cv::Mat& strengths);

// Appends the pixels of the area that are stronger than the threshold and than each of their eight neighbours, row by
// row. Precondition: the area keeps a pixel from the border.
void append_peaks(const cv::Mat& strengths, const cv::Rect& area, int threshold, std::vector<Corner>& corners);

}  // namespace byre
