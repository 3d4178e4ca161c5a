#pragma once

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

}  // namespace byre
