#pragma once

#include "byre/features.h"
#include "byre/features/downscale.h"

#include <array>

#include <opencv2/core.hpp>

namespace byre {

// The same image at every octave. Pixel x of octave o lies at (x + 0.5) * kScaleOfOctave[o] - 0.5 of the image.
struct Pyramid {
  std::array<cv::Mat, kOctaves> levels;  // 8-bit grey; empty where the image is too small for the octave
  // To each level from the one before, for images of the size seen last.
  std::array<Downscale, kOctaves> downscales = {};
};

// Refills the pyramid in place; its memory is used again. The image itself becomes octave 0 and is not copied.
void build_pyramid(const cv::Mat& image, Pyramid& pyramid);

inline Eigen::Vector2f full_from_octave(const Eigen::Vector2f& octave_pixel, int octave) {
  const float scale = kScaleOfOctave[static_cast<std::size_t>(octave)];
  return (octave_pixel.array() + 0.5f) * scale - 0.5f;
}

inline Eigen::Vector2f octave_from_full(const Eigen::Vector2f& pixel, int octave) {
  const float scale = kScaleOfOctave[static_cast<std::size_t>(octave)];
  return (pixel.array() + 0.5f) / scale - 0.5f;
}

}  // namespace byre
