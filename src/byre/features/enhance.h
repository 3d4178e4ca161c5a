#pragma once

#include "byre/image_condition.h"

#include <opencv2/core.hpp>

namespace byre {

// Enhancement of an image taken in poor light before feature detection: smoothing according to its noise, and
// amplification if it is dull or dark. Images taken in good light are unchanged.
struct Enhancement {
  float smoothing = 0.0f;  // pixels, standard deviation of a Gaussian; 0: none
  float gain = 1.0f;
  float offset = 0.0f;            // grey values, after the gain
  bool uses_square_root = false;  // bright values are amplified less, by a square root; gain applies at black

  bool is_active() const { return smoothing > 0.0f || gain != 1.0f; }
};

Enhancement choose_enhancement(const ImageCondition& condition);

// Precondition: the enhancement changes something. `enhanced` must be another image than `image`. `fine` is an
// intermediate float image, because smoothing resolves fractions of grey values. The memory of both is reused.
void enhance(const Enhancement& enhancement, const cv::Mat& image, cv::Mat& fine, cv::Mat& enhanced);

// Predicted condition of the enhanced image, except its sharpness.
ImageCondition condition_after_enhancement(const Enhancement& enhancement, const ImageCondition& condition);

}  // namespace byre
