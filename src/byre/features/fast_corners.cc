#include "byre/features/fast_corners.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cassert>
#include <cstddef>
#include <cstdint>

// The vectorised part of this file is compiled once for each instruction set that supports arrays of vectors.
#define HWY_DISABLED_TARGETS (HWY_SVE | HWY_SVE2 | HWY_SVE_256 | HWY_SVE2_128 | HWY_RVV)
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "byre/features/fast_corners.cc"
#include <hwy/foreach_target.h>
// After foreach_target.h.
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace byre::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

constexpr std::size_t kCircle = 16;

// Over all arcs of nine contiguous values on the circle: the largest minimum and the smallest maximum.
template <class V>
HWY_INLINE void find_extreme_arcs(const V* on_circle, V& min_of_brightest, V& max_of_darkest) {
  // Extremes of two, four and eight contiguous values, from every second position of the circle.
  V low_two[kCircle], high_two[kCircle], low_four[kCircle], high_four[kCircle];
  for (std::size_t i = 1; i < kCircle; i += 2) {
    low_two[i] = hn::Min(on_circle[i], on_circle[(i + 1) % kCircle]);
    high_two[i] = hn::Max(on_circle[i], on_circle[(i + 1) % kCircle]);
  }
  for (std::size_t i = 1; i < kCircle; i += 2) {
    low_four[i] = hn::Min(low_two[i], low_two[(i + 2) % kCircle]);
    high_four[i] = hn::Max(high_two[i], high_two[(i + 2) % kCircle]);
  }
  for (std::size_t i = 1; i < kCircle; i += 2) {
    const V low_eight = hn::Min(low_four[i], low_four[(i + 4) % kCircle]);
    const V high_eight = hn::Max(high_four[i], high_four[(i + 4) % kCircle]);
    // The ninth value is before or after these.
    const V before = on_circle[i - 1], after = on_circle[(i + 8) % kCircle];
    const V low = hn::Min(low_eight, hn::Max(before, after)), high = hn::Max(high_eight, hn::Min(before, after));
    min_of_brightest = i == 1 ? low : hn::Max(min_of_brightest, low);
    max_of_darkest = i == 1 ? high : hn::Min(max_of_darkest, high);
  }
}

// Strengths of at least as many neighbouring pixels as a vector has lanes. offsets: from a pixel to its circle.
void measure_row(const std::uint8_t* pixels, const std::ptrdiff_t* offsets, std::size_t count, std::uint8_t threshold,
                 std::uint8_t* strengths) {
  const hn::CappedTag<std::uint8_t, 32> d;
  using V = hn::Vec<decltype(d)>;
  const std::size_t lanes = hn::Lanes(d);
  const auto limit = hn::Set(d, threshold);
  for (std::size_t x = 0; x < count; x += lanes) {
    // The last vector overlaps with the previous one, to stay inside the row.
    const std::size_t at = x + lanes <= count ? x : count - lanes;
    const auto centre = hn::LoadU(d, pixels + at);
    const auto neighbour = [&](std::size_t i) { return hn::LoadU(d, pixels + at + offsets[i]); };
    // Nine contiguous pixels contain one of each two opposite ones.
    const auto n0 = neighbour(0), n4 = neighbour(4), n8 = neighbour(8), n12 = neighbour(12);
    const auto brighter = hn::SaturatedSub(hn::Min(hn::Max(n0, n8), hn::Max(n4, n12)), centre);
    const auto darker = hn::SaturatedSub(centre, hn::Max(hn::Min(n0, n8), hn::Min(n4, n12)));
    auto strength = hn::Zero(d);
    if (!hn::AllFalse(d, hn::Gt(hn::Max(brighter, darker), limit))) {
      V on_circle[kCircle];
      for (std::size_t i = 0; i < kCircle; ++i) on_circle[i] = neighbour(i);
      V min_of_brightest, max_of_darkest;
      find_extreme_arcs(on_circle, min_of_brightest, max_of_darkest);
      strength = hn::Max(hn::SaturatedSub(min_of_brightest, centre), hn::SaturatedSub(centre, max_of_darkest));
      strength = hn::IfThenElseZero(hn::Gt(strength, limit), strength);
    }
    hn::StoreU(strength, d, strengths + at);
  }
}

// Pixels of a row that are stronger than the threshold and than their neighbours. Branchless, because branch prediction
// would fail about as often as not.
template <class D, class V>
HWY_INLINE hn::Mask<D> peaks_among(D d, const std::uint8_t* strengths, std::ptrdiff_t stride, V limit) {
  const auto centre = hn::LoadU(d, strengths);
  const auto row_around = [&](const std::uint8_t* middle) {
    return hn::Max(hn::LoadU(d, middle - 1), hn::LoadU(d, middle + 1));
  };
  const auto above = hn::Max(row_around(strengths - stride), hn::LoadU(d, strengths - stride));
  const auto below = hn::Max(row_around(strengths + stride), hn::LoadU(d, strengths + stride));
  const auto around = hn::Max(hn::Max(above, below), row_around(strengths));
  return hn::Gt(centre, hn::Max(around, limit));
}

// Sets one bit per pixel of a row that is a peak, the first pixel in the lowest bit. Needs at least as many pixels as a
// vector has lanes; writes whole words.
void mark_peaks(const std::uint8_t* strengths, std::ptrdiff_t stride, std::size_t count, std::uint8_t threshold,
                std::uint64_t* marks) {
  const hn::CappedTag<std::uint8_t, 32> d;
  const std::size_t lanes = hn::Lanes(d);
  const auto limit = hn::Set(d, threshold);
  auto* const bytes = reinterpret_cast<std::uint8_t*>(marks);
  std::size_t x = 0;
  for (; x + lanes <= count; x += lanes) {
    hn::StoreMaskBits(d, peaks_among(d, strengths + x, stride, limit), bytes + x / 8);
  }
  for (std::size_t byte = x / 8; byte % 8 != 0 || 8 * byte < count; ++byte) bytes[byte] = 0;
  if (x == count) return;
  // The last vector overlaps with the previous one, to stay inside the row.
  const std::size_t at = count - lanes;
  std::uint8_t last[8] = {};
  hn::StoreMaskBits(d, peaks_among(d, strengths + at, stride, limit), last);
  for (std::size_t i = x - at; i < lanes; ++i) {
    const std::size_t pixel = at + i;
    bytes[pixel / 8] = static_cast<std::uint8_t>(bytes[pixel / 8] | (last[i / 8] >> (i % 8) & 1) << (pixel % 8));
  }
}

std::size_t lanes_of_rows() {
  return hn::Lanes(hn::CappedTag<std::uint8_t, 32>());
}

}  // namespace
}  // namespace byre::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE

namespace byre {
namespace {

HWY_EXPORT(measure_row);
HWY_EXPORT(mark_peaks);
HWY_EXPORT(lanes_of_rows);

// Clockwise from below; column and row.
constexpr std::array<std::array<int, 2>, 16> kCirclePlaces = {{{0, 3},
                                                               {1, 3},
                                                               {2, 2},
                                                               {3, 1},
                                                               {3, 0},
                                                               {3, -1},
                                                               {2, -2},
                                                               {1, -3},
                                                               {0, -3},
                                                               {-1, -3},
                                                               {-2, -2},
                                                               {-3, -1},
                                                               {-3, 0},
                                                               {-3, 1},
                                                               {-2, 2},
                                                               {-1, 3}}};

std::uint8_t strength_of(const std::uint8_t* pixel, const std::ptrdiff_t* offsets, int threshold) {
  int strongest = 0;
  for (std::size_t first = 0; first < 16; ++first) {
    int least_above = 255, least_below = 255;
    for (std::size_t i = 0; i < 9; ++i) {
      const int difference = pixel[offsets[(first + i) % 16]] - pixel[0];
      least_above = std::min(least_above, difference);
      least_below = std::min(least_below, -difference);
    }
    strongest = std::max({strongest, least_above, least_below});
  }
  return static_cast<std::uint8_t>(strongest > threshold ? strongest : 0);
}

bool is_peak(const std::uint8_t* strength, std::ptrdiff_t stride, int threshold) {
  if (*strength <= threshold) return false;
  for (const std::ptrdiff_t row : {-stride, std::ptrdiff_t{0}, stride}) {
    for (const std::ptrdiff_t column : {-1, 0, 1}) {
      if ((row != 0 || column != 0) && strength[row + column] >= *strength) return false;
    }
  }
  return true;
}

void clear_outside(const cv::Rect& area, cv::Mat& strengths) {
  for (int y = 0; y < strengths.rows; ++y) {
    std::uint8_t* const row = strengths.ptr<std::uint8_t>(y);
    const bool is_row_inside = y >= area.y && y < area.y + area.height;
    const int left = is_row_inside ? area.x : strengths.cols;
    const int right = is_row_inside ? area.x + area.width : strengths.cols;
    std::fill(row, row + left, std::uint8_t{0});
    std::fill(row + right, row + strengths.cols, std::uint8_t{0});
  }
}

}  // namespace

void measure_fast_strengths(const cv::Mat& image, const cv::Rect& area, int threshold, cv::Mat& strengths) {
  assert(image.type() == CV_8U && threshold >= 0 && threshold < 255);
  assert(area.x >= kFastRadius && area.x + area.width <= image.cols - kFastRadius);
  assert(area.y >= kFastRadius && area.y + area.height <= image.rows - kFastRadius);
  strengths.create(image.size(), CV_8U);
  std::array<std::ptrdiff_t, 16> offsets;
  for (std::size_t i = 0; i < 16; ++i) {
    offsets[i] = kCirclePlaces[i][1] * static_cast<std::ptrdiff_t>(image.step) + kCirclePlaces[i][0];
  }
  const auto width = static_cast<std::size_t>(area.width);
  const bool is_narrow = width < HWY_DYNAMIC_DISPATCH(lanes_of_rows)();
  clear_outside(area, strengths);
  for (int y = area.y; y < area.y + area.height; ++y) {
    const std::uint8_t* const pixels = image.ptr<std::uint8_t>(y) + area.x;
    std::uint8_t* const row = strengths.ptr<std::uint8_t>(y) + area.x;
    if (!is_narrow) {
      HWY_DYNAMIC_DISPATCH(measure_row)
      (pixels, offsets.data(), width, static_cast<std::uint8_t>(threshold), row);
      continue;
    }
    for (std::size_t x = 0; x < width; ++x) row[x] = strength_of(pixels + x, offsets.data(), threshold);
  }
}

void append_peaks(const cv::Mat& strengths, const cv::Rect& area, int threshold, ScratchVector<Corner>& corners) {
  assert(area.x > 0 && area.x + area.width < strengths.cols && area.y > 0 && area.y + area.height < strengths.rows);
  const auto stride = static_cast<std::ptrdiff_t>(strengths.step);
  const auto width = static_cast<std::size_t>(area.width);
  const bool is_narrow = width < HWY_DYNAMIC_DISPATCH(lanes_of_rows)();
  constexpr std::size_t kBits = 64;
  ScratchVector<std::uint64_t> marks(width / kBits + 1);
  for (int y = area.y; y < area.y + area.height; ++y) {
    const std::uint8_t* const row = strengths.ptr<std::uint8_t>(y) + area.x;
    const auto append = [&](int x) { corners.push_back({area.x + x, y, static_cast<float>(row[x] - 1)}); };
    if (is_narrow) {
      for (int x = 0; x < area.width; ++x) {
        if (is_peak(row + x, stride, threshold)) append(x);
      }
      continue;
    }
    HWY_DYNAMIC_DISPATCH(mark_peaks)(row, stride, width, static_cast<std::uint8_t>(threshold), marks.data());
    for (std::size_t word = 0; word * kBits < width; ++word) {
      for (std::uint64_t left = marks[word]; left != 0; left &= left - 1) {
        append(static_cast<int>(word * kBits) + std::countr_zero(left));
      }
    }
  }
}

}  // namespace byre

#endif
