#pragma once

#include "byre/image_condition.h"

#include <opencv2/core.hpp>

namespace byre {

// How an image taken in poor light is brought out before features are looked for, as a photograph is developed:
// smoothed as much as its noise asks for, and amplified where it is dull or dark. Images taken in good light stay as
// they are.
struct Development {
  float smoothing = 0.0f;  // pixels, standard deviation of a Gaussian; 0: none
  float gain = 1.0f;
  float offset = 0.0f;     // grey values, after the gain
  bool is_curved = false;  // what is bright is amplified less, along a square root; the gain is that of black

  bool changes_anything() const { return smoothing > 0.0f || gain != 1.0f; }
};

Development development_for(const ImageCondition& condition);

// Precondition: it changes something. developed is another image; fine is what comes between, floats, as smoothing
// tells more grey values apart. The memory of both is used again.
void develop(const Development& development, const cv::Mat& image, cv::Mat& fine, cv::Mat& developed);

// What the image is like afterwards, but for its sharpness.
ImageCondition condition_after(const Development& development, const ImageCondition& condition);

}  // namespace byre
