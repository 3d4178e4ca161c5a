#include "byre/features/remap.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstddef>

// The vectorised part of this file is compiled once for each instruction set.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "byre/features/remap.cc"
#include <hwy/foreach_target.h>
// After foreach_target.h.
#include "byre/features/pairwise_sums-inl.h"

HWY_BEFORE_NAMESPACE();
namespace byre::HWY_NAMESPACE {
namespace {

// Values of two neighbours in a row, from four bytes read at the left one: as two lanes of 16 bits.
template <class D32>
HWY_INLINE hn::Vec<D32> two_pixels(D32 d32, hn::Vec<D32> bytes) {
  const auto left = hn::And(bytes, hn::Set(d32, 0xff));
  const auto right = hn::And(bytes, hn::Set(d32, 0xff00));
  return hn::Or(left, hn::ShiftLeft<8>(right));
}

// Weights of two neighbours, (32 - fraction, fraction), as two lanes of 16 bits.
template <class D32>
HWY_INLINE hn::Vec<D32> two_weights(D32 d32, const std::uint8_t* fractions) {
  const hn::Rebind<std::uint8_t, D32> d8;
  const auto fraction = hn::PromoteTo(d32, hn::LoadU(d8, fractions));
  return hn::Add(hn::Sub(hn::ShiftLeft<16>(fraction), fraction), hn::Set(d32, 32));
}

// Makes the first pixels, as many as fill whole vectors, and returns how many. Arrays hold one value a pixel.
std::size_t look_up(const std::uint8_t* source, std::ptrdiff_t stride, const std::int32_t* offsets,
                    const std::uint8_t* column_fractions, const std::uint8_t* row_fractions, std::size_t count,
                    std::uint8_t* made) {
  const hn::ScalableTag<std::int32_t> d32;
  const hn::Repartition<std::int16_t, decltype(d32)> d16;
  const hn::Rebind<std::uint8_t, decltype(d32)> d8;
  const auto weighted = [&](auto pixels, auto weights) {
    return pairwise_sums(d32, hn::BitCast(d16, pixels), hn::BitCast(d16, weights));
  };
  const auto* const upper_row = reinterpret_cast<const std::int32_t*>(source);
  const auto* const lower_row = reinterpret_cast<const std::int32_t*>(source + stride);
  std::size_t i = 0;
  for (; i + hn::Lanes(d32) <= count; i += hn::Lanes(d32)) {
    const auto at = hn::LoadU(d32, offsets + i);
    const auto columns = two_weights(d32, column_fractions + i);
    const auto upper = weighted(two_pixels(d32, hn::GatherOffset(d32, upper_row, at)), columns);
    const auto lower = weighted(two_pixels(d32, hn::GatherOffset(d32, lower_row, at)), columns);
    const auto both = hn::Or(upper, hn::ShiftLeft<16>(lower));
    const auto sums = hn::Add(weighted(both, two_weights(d32, row_fractions + i)), hn::Set(d32, 512));
    hn::StoreU(hn::DemoteTo(d8, hn::ShiftRight<10>(sums)), d8, made + i);
  }
  return i;
}

}  // namespace
}  // namespace byre::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE

namespace byre {
namespace {

HWY_EXPORT(look_up);

constexpr int kSteps = 32;       // places between two pixels
constexpr int kBytesAtOnce = 4;  // bytes, of which the first two are used

struct Neighbours {
  int pixel = 0;     // with a neighbour after it
  int fraction = 0;  // 0 to kSteps, of the way to that neighbour
};

// What lies outside is on the outermost pixel.
Neighbours neighbours_of(float coordinate, int size) {
  const float inside = std::min(std::max(coordinate, 0.0f), static_cast<float>(size - 1));
  const int steps = cvRound(inside * kSteps);
  if (steps / kSteps >= size - 1) return {size - 2, kSteps};
  return {steps / kSteps, steps % kSteps};
}

}  // namespace

Remap::Remap(const cv::Mat& columns, const cv::Mat& rows, cv::Size source) : size_(columns.size()), source_(source) {
  assert(columns.size() == rows.size() && source.width >= 2 && source.height >= 2);
  const auto count = static_cast<std::size_t>(size_.area());
  offsets_.reserve(count);
  column_fractions_.reserve(count);
  row_fractions_.reserve(count);
  const int last = source.area() - source.width - kBytesAtOnce;
  for (int v = 0; v < size_.height; ++v) {
    for (int u = 0; u < size_.width; ++u) {
      const Neighbours column = neighbours_of(columns.at<float>(v, u), source.width);
      const Neighbours row = neighbours_of(rows.at<float>(v, u), source.height);
      const int offset = row.pixel * source.width + column.pixel;
      if (offset > last) at_the_end_.push_back({offsets_.size(), offset});
      offsets_.push_back(std::clamp(offset, 0, std::max(0, last)));
      column_fractions_.push_back(static_cast<std::uint8_t>(column.fraction));
      row_fractions_.push_back(static_cast<std::uint8_t>(row.fraction));
    }
  }
}

std::uint8_t Remap::value(const std::uint8_t* upper, std::size_t pixel) const {
  const int column = column_fractions_[pixel], row = row_fractions_[pixel];
  const std::uint8_t* const lower = upper + source_.width;
  const int above = (kSteps - column) * upper[0] + column * upper[1];
  const int below = (kSteps - column) * lower[0] + column * lower[1];
  return static_cast<std::uint8_t>(((kSteps - row) * above + row * below + kSteps * kSteps / 2) / (kSteps * kSteps));
}

void Remap::apply(const cv::Mat& image, cv::Mat& made) const {
  assert(image.type() == CV_8U && image.size() == source_ && image.isContinuous());
  made.create(size_, CV_8U);
  const std::uint8_t* const source = image.ptr<std::uint8_t>();
  std::uint8_t* const values = made.ptr<std::uint8_t>();
  std::size_t pixel =
      source_.area() < source_.width + kBytesAtOnce
          ? 0
          : HWY_DYNAMIC_DISPATCH(look_up)(source, source_.width, offsets_.data(), column_fractions_.data(),
                                          row_fractions_.data(), offsets_.size(), values);
  for (; pixel < offsets_.size(); ++pixel) values[pixel] = value(source + offsets_[pixel], pixel);
  for (const auto& [index, offset] : at_the_end_) values[index] = value(source + offset, index);
}

}  // namespace byre

#endif
