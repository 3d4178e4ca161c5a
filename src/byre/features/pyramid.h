#pragma once

#include "byre/features.h"

#include <array>
#include <cstdint>
#include <vector>

#include <opencv2/core.hpp>

namespace byre {

// Downscales images of one size by one factor, with bilinear interpolation. Same values as cv::resize with
// cv::INTER_LINEAR.
class Downscale {
 public:
  static constexpr int kMinSide = 24;  // pixels
  static constexpr double kMaxFactor = 1.8;

  Downscale() = default;  // not usable
  // Preconditions: 1 < factor <= kMaxFactor; the source has at least kMinSide pixels each way.
  Downscale(cv::Size source, double factor);

  cv::Size source() const { return source_; }
  // Refills `made`. Precondition: the image is 8-bit grey, of the size given.
  void apply(const cv::Mat& image, cv::Mat& made) const;

  // Interpolation of neighbouring pixels of a row from sixteen source pixels.
  struct Group {
    static constexpr int kPixels = 8;

    std::int32_t first = 0;                              // source column
    std::array<std::uint8_t, 4 * kPixels> neighbours{};  // two of the sixteen per pixel, in 16 bits each
    std::array<std::int16_t, 2 * kPixels> weights{};     // two per pixel, with the sum 2048
  };

 private:
  struct Row {
    int upper = 0;
    int lower = 0;
    std::int16_t upper_weight = 0;
    std::int16_t lower_weight = 0;  // both weights sum to 2048
  };

  cv::Size source_;
  cv::Size size_;
  std::vector<Group> groups_;
  std::vector<Row> rows_;
};

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
