#pragma once

#include <opencv2/core.hpp>

namespace byre {

// Blurs 8-bit grey values with a Gaussian of 7 x 7 pixels and a standard deviation of 2, with weights in 256ths. The
// border is mirrored about its outermost pixels. Same values as cv::GaussianBlur. Preconditions: the image has at least
// 4 x 4 pixels; `blurred` is another image.
void gaussian_blur(const cv::Mat& image, cv::Mat& blurred);

}  // namespace byre
