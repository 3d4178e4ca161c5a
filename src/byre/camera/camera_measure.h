#pragma once

#include "byre/image.h"

#include <array>
#include <optional>
#include <vector>

namespace byre {

struct CornerGrid {
  static constexpr int kColumns = 8;
  static constexpr int kRows = 6;
  std::array<int, kColumns * kRows> corners{};  // row by row

  int total() const;
  int empty_cells() const;
};

// FAST corners with the first threshold of tracking.
CornerGrid count_corners(const Image& image);

struct StampIntervals {
  double rate_hz = 0.0;
  double deviation_s = 0.0;  // standard deviation of the intervals
  double longest_s = 0.0;
};

// Empty for fewer than three stamps.
std::optional<StampIntervals> measure_intervals(const std::vector<Timestamp>& stamps);

}  // namespace byre
