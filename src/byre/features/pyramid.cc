#include "byre/features/pyramid.h"

namespace byre {

void build_pyramid(const cv::Mat& image, Pyramid& pyramid) {
  constexpr int kMinSide = 48;  // pixels; smaller images have no keypoint far enough from the border
  pyramid.levels[0] = image;
  for (std::size_t octave = 1; octave < kOctaves; ++octave) {
    const cv::Mat& finer = pyramid.levels[octave - 1];
    cv::Mat& level = pyramid.levels[octave];
    if (finer.empty() || std::min(finer.cols, finer.rows) < kMinSide * kOctaveScale) {
      level.release();
      continue;
    }
    Downscale& downscale = pyramid.downscales[octave];
    if (downscale.source() != finer.size()) downscale = Downscale(finer.size(), kOctaveScale);
    downscale.apply(finer, level);
  }
}

}  // namespace byre
