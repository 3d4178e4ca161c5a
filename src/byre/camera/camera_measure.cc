#include "byre/camera/camera_measure.h"

#include "byre/features/fast_corners.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace byre {

int CornerGrid::total() const {
  return std::accumulate(corners.begin(), corners.end(), 0);
}

int CornerGrid::empty_cells() const {
  return static_cast<int>(std::ranges::count(corners, 0));
}

CornerGrid count_corners(const Image& image) {
  constexpr int kThreshold = 20;  // grey values
  constexpr int kBorder = kFastRadius + 1;
  CornerGrid grid;
  if (image.width <= 2 * kBorder || image.height <= 2 * kBorder) return grid;
  const cv::Mat pixels(image.height, image.width, CV_8UC1, const_cast<std::uint8_t*>(image.pixels.data()));
  const cv::Rect area(kBorder, kBorder, image.width - 2 * kBorder, image.height - 2 * kBorder);
  cv::Mat strengths;
  measure_fast_strengths(pixels, area, kThreshold, strengths);
  ScratchVector<Corner> corners;
  append_peaks(strengths, area, kThreshold, corners);
  for (const Corner& corner : corners) {
    const int column = corner.x * CornerGrid::kColumns / image.width;
    const int row = corner.y * CornerGrid::kRows / image.height;
    ++grid.corners[static_cast<std::size_t>(row * CornerGrid::kColumns + column)];
  }
  return grid;
}

std::optional<StampIntervals> measure_intervals(const std::vector<Timestamp>& stamps) {
  if (stamps.size() < 3) return std::nullopt;
  StampIntervals intervals;
  const auto count = static_cast<double>(stamps.size() - 1);
  const double mean = to_seconds(stamps.back() - stamps.front()) / count;
  double squares = 0.0;
  for (std::size_t i = 1; i < stamps.size(); ++i) {
    const double interval = to_seconds(stamps[i] - stamps[i - 1]);
    squares += (interval - mean) * (interval - mean);
    intervals.longest_s = std::max(intervals.longest_s, interval);
  }
  intervals.rate_hz = mean > 0.0 ? 1.0 / mean : 0.0;
  intervals.deviation_s = std::sqrt(squares / count);
  return intervals;
}

}  // namespace byre
