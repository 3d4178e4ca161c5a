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

  bool empty() const { return size_.empty(); }
  cv::Size size() const { return size_; }
  // Refills `made`. Precondition: the image is 8-bit grey, without gaps between rows, of the size that was given.
  void apply(const cv::Mat& image, cv::Mat& made) const;
  // The source row that a pixel comes from, rounded down.
  int source_row(cv::Point pixel) const;

 private:
  // A pixel that is looked up by itself.
  struct SinglePixel {
    std::size_t pixel = 0;    // index in the image that is made
    std::int32_t offset = 0;  // source pixel, the upper left of four neighbours
    int column_fraction = 0;  // 0 to 32
    int row_fraction = 0;
  };

  // Neighbouring pixels are looked up together, where all they come from lies in a few bytes of a few rows.
  struct Group;
  static Group group_of(const SinglePixel* pixels, cv::Size source);
  void add(const SinglePixel* pixels);
  std::uint8_t value(const std::uint8_t* source, const SinglePixel& pixel) const;

  cv::Size size_;
  cv::Size source_;
  // Where the first row of each group is read, and in how many rows its pixels lie.
  std::vector<std::int32_t> first_;
  std::vector<std::uint8_t> rows_;
  // A number a pixel of the groups; from the lowest bit on: column fraction (5 bits), row fraction (5), column after
  // the group's first (4), row after it (2). Numbers are small because reading them from memory takes most of the time.
  std::vector<std::uint16_t> places_;
  std::vector<SinglePixel> singles_;  // ascending; in groups that do not fit, and after the last group
};

}  // namespace byre
