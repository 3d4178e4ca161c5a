#pragma once

#include "byre/image_condition.h"

#include <opencv2/core.hpp>

namespace byre {

// Enhancement of an image taken in poor light before feature detection: smoothing according to its noise, and
// amplification if it is dull or dark. Images taken in good light are unchanged.
struct Development {
  float smoothing = 0.0f;  // pixels, standard deviation of a Gaussian; 0: none
  float gain = 1.0f;
  float offset = 0.0f;     // grey values, after the gain
  bool is_curved = false;  // bright values are amplified less, by a square root; gain applies at black

  bool changes_anything() const { return smoothing > 0.0f || gain != 1.0f; }
};

Development development_for(const ImageCondition& condition);

// Precondition: the development changes something. `developed` must be another image than `image`. `fine` is an
// intermediate float image, because smoothing resolves fractions of grey values. The memory of both is reused.
void develop(const Development& development, const cv::Mat& image, cv::Mat& fine, cv::Mat& developed);

// Predicted condition of the developed image, except its sharpness.
ImageCondition condition_after(const Development& development, const ImageCondition& condition);

}  // namespace byre
