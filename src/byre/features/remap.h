#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include <opencv2/core.hpp>

namespace byre {

// Where the pixels of one image lie in another, kept ready to look them up in many images of the same size. What lies
// outside takes the value of the nearest pixel. Same values as cv::remap with cv::INTER_LINEAR and
// cv::BORDER_REPLICATE, which interpolates in 32 steps.
class Remap {
 public:
  Remap() = default;  // makes none
  // Places are whole and fractional source pixels (CV_32F), one a pixel of the image that is made. Precondition: both
  // of one size; the source has at least 2 x 2 pixels.
  Remap(const cv::Mat& columns, const cv::Mat& rows, cv::Size source);

  bool empty() const { return offsets_.empty(); }
  cv::Size size() const { return size_; }
  // Refills `made`. Precondition: the image is 8-bit grey, without gaps between rows, of the size that was given.
  void apply(const cv::Mat& image, cv::Mat& made) const;
  // The source row that a pixel comes from, rounded down.
  int source_row(cv::Point pixel) const {
    return offsets_[static_cast<std::size_t>(pixel.y * size_.width + pixel.x)] / source_.width;
  }

 private:
  // A pixel that is not in reach of reading several bytes at once.
  struct PixelAtTheEnd {
    std::size_t pixel = 0;  // index in the image that is made
    std::int32_t offset = 0;
  };

  // Between the pixel at `upper` and its three neighbours.
  std::uint8_t value(const std::uint8_t* upper, std::size_t pixel) const;

  cv::Size size_;
  cv::Size source_;
  std::vector<std::int32_t> offsets_;           // source pixel, the upper left of four neighbours
  std::vector<std::uint8_t> column_fractions_;  // 0 to 32
  std::vector<std::uint8_t> row_fractions_;     // 0 to 32
  std::vector<PixelAtTheEnd> at_the_end_;       // their offsets_ are the last that may be read
};

}  // namespace byre
