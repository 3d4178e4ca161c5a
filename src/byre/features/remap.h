#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include <opencv2/core.hpp>

namespace byre {

// Lookup table from the pixels of one image to positions in another, for many images of the same size. Positions
// outside take the value of the nearest pixel. Same values as cv::remap with cv::INTER_LINEAR and cv::BORDER_REPLICATE,
// which interpolates in 32 steps.
class Remap {
 public:
  Remap() = default;  // empty
  // Positions are source pixels with fractions (CV_32F), one per pixel of the result. Preconditions: both of one size;
  // the source has at least 2 x 2 pixels.
  Remap(const cv::Mat& columns, const cv::Mat& rows, cv::Size source);

  bool empty() const { return size_.empty(); }
  cv::Size size() const { return size_; }
  // Refills `made`. Precondition: the image is 8-bit grey, without gaps between rows, of the size given.
  void apply(const cv::Mat& image, cv::Mat& made) const;
  // Source row of a pixel, rounded down.
  int source_row(cv::Point pixel) const;

 private:
  // A pixel that is looked up individually.
  struct SinglePixel {
    std::size_t pixel = 0;    // index in the result
    std::int32_t offset = 0;  // source pixel, the upper left of four neighbours
    int column_fraction = 0;  // 0 to 32
    int row_fraction = 0;
  };

  // Neighbouring pixels that are looked up together, if their sources are within a few bytes of a few rows.
  struct Group;
  static Group group_of(const SinglePixel* pixels, cv::Size source);
  void add(const SinglePixel* pixels);
  std::uint8_t value(const std::uint8_t* source, const SinglePixel& pixel) const;

  cv::Size size_;
  cv::Size source_;
  // Offset of each group's first row in the source, and number of source rows.
  std::vector<std::int32_t> first_;
  std::vector<std::uint8_t> rows_;
  // One number per pixel of the groups; from the lowest bit: column fraction (5 bits), row fraction (5), column after
  // the group's first (4), row after it (2). Compact because reading them from memory takes most of the time.
  std::vector<std::uint16_t> places_;
  std::vector<SinglePixel> singles_;  // ascending; pixels of groups that do not fit, and after the last group
};

}  // namespace byre
