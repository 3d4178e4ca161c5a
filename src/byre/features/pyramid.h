#pragma once

#include "byre/features.h"
#include "byre/features/downscale.h"

#include <array>

#include <opencv2/core.hpp>

namespace byre {

// Image pyramid. Pixel x of octave o is at (x + 0.5) * kScaleOfOctave[o] - 0.5 of the image.
struct Pyramid {
  std::array<cv::Mat, kOctaves> levels;  // 8-bit grey; empty if the image is too small for the octave
  // Downscales each level from the previous one, for the last image size.
  std::array<Downscale, kOctaves> downscales = {};
};

// Refills the pyramid in place and reuses its memory. The image becomes octave 0 without a copy.
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
