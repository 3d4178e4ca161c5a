#include "byre/features/pyramid.h"

#include <opencv2/imgproc.hpp>

namespace byre {

void build_pyramid(const cv::Mat& image, Pyramid& pyramid) {
  constexpr int kMinSide = 48;  // pixels: below it no keypoint keeps its distance from the border
  pyramid.levels[0] = image;
  for (std::size_t octave = 1; octave < kOctaves; ++octave) {
    const cv::Mat& finer = pyramid.levels[octave - 1];
    cv::Mat& level = pyramid.levels[octave];
    if (finer.empty() || std::min(finer.cols, finer.rows) < kMinSide * kOctaveScale) {
      level.release();
      continue;
    }
    // The factor is given rather than the size, so that rounding the size does not change the scale.
    cv::resize(finer, level, cv::Size(), 1.0 / kOctaveScale, 1.0 / kOctaveScale, cv::INTER_LINEAR);
  }
}

}  // namespace byre
