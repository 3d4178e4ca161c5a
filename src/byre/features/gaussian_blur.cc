#include "byre/features/gaussian_blur.h"

#include "byre/base/scratch_memory.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cstddef>
#include <cstdint>

#include <opencv2/imgproc.hpp>

// The vectorised part of this file is compiled once for each instruction set.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "byre/features/gaussian_blur.cc"
#include <hwy/foreach_target.h>
// After foreach_target.h.
#include "byre/features/pairwise_sums-inl.h"

HWY_BEFORE_NAMESPACE();
namespace byre::HWY_NAMESPACE {
namespace {

// Weights in 256ths, from the outermost tap to the middle one.
constexpr int kTap0 = 18, kTap1 = 34, kTap2 = 48, kTap3 = 56;

// Weighted sums of seven rows, up to 65280. Rows are padded to whole vectors.
void add_rows(const std::uint8_t* const* rows, std::size_t width, std::uint16_t* sums) {
  const hn::ScalableTag<std::uint16_t> d16;
  const hn::Rebind<std::uint8_t, decltype(d16)> d8;
  const auto two = [&](int above, int below, std::size_t x, int tap) {
    const auto sum =
        hn::Add(hn::PromoteTo(d16, hn::LoadU(d8, rows[above] + x)), hn::PromoteTo(d16, hn::LoadU(d8, rows[below] + x)));
    return hn::Mul(sum, hn::Set(d16, static_cast<std::uint16_t>(tap)));
  };
  const std::size_t lanes = hn::Lanes(d16);
  for (std::size_t x = 0; x < width; x += lanes) {
    // The last vector overlaps with the previous one, to stay inside the row.
    const std::size_t at = x + lanes <= width ? x : width - lanes;
    const auto middle = hn::Mul(hn::PromoteTo(d16, hn::LoadU(d8, rows[3] + at)), hn::Set(d16, kTap3));
    const auto outer = hn::Add(two(0, 6, at, kTap0), two(1, 5, at, kTap1));
    hn::StoreU(hn::Add(hn::Add(outer, two(2, 4, at, kTap2)), middle), d16, sums + at);
  }
}

// Weighted sums of seven neighbours in a row, rounded to grey values. sums begins three to the left of the first pixel;
// a vector's width beyond its end is readable.
void add_columns(const std::uint16_t* sums, std::size_t width, std::uint8_t* blurred) {
  const hn::ScalableTag<std::int16_t> d16;
  const hn::RebindToUnsigned<decltype(d16)> du16;
  const hn::RepartitionToWide<decltype(d16)> d32;
  const hn::RepartitionToWide<decltype(du16)> du32;
  const hn::Rebind<std::uint8_t, decltype(d16)> d8;
  const auto taps01 = repeated_pair(d16, kTap0, kTap1), taps23 = repeated_pair(d16, kTap2, kTap3);
  const auto taps21 = repeated_pair(d16, kTap2, kTap1), tap0 = repeated_pair(d16, kTap0, 0);
  const auto to_signed = hn::Set(du16, 0x8000);
  // Compensates to_signed, and rounds.
  const auto offset = hn::Set(d32, 256 * 0x8000 + 0x8000);
  const auto load = [&](std::size_t x) { return hn::BitCast(d16, hn::Xor(hn::LoadU(du16, sums + x), to_signed)); };
  // Sums at every second pixel from x, in the upper 16 bits.
  const auto every_second = [&](std::size_t x) {
    const auto left = hn::Add(pairwise_sums(d32, load(x), taps01), pairwise_sums(d32, load(x + 2), taps23));
    const auto right = hn::Add(pairwise_sums(d32, load(x + 4), taps21), pairwise_sums(d32, load(x + 6), tap0));
    return hn::BitCast(du32, hn::Add(hn::Add(left, right), offset));
  };
  const std::size_t lanes = hn::Lanes(d16);
  for (std::size_t x = 0; x < width; x += lanes) {
    const std::size_t at = x + lanes <= width ? x : width - lanes;
    const auto even = hn::ShiftRight<16>(every_second(at));
    const auto odd = hn::And(every_second(at + 1), hn::Set(du32, 0xffff0000U));
    hn::StoreU(hn::DemoteTo(d8, hn::BitCast(d16, hn::Or(even, odd))), d8, blurred + at);
  }
}

// The widest vector, in pixels.
std::size_t lanes_of_sums() {
  return hn::Lanes(hn::ScalableTag<std::uint16_t>());
}

}  // namespace
}  // namespace byre::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE

namespace byre {
namespace {

HWY_EXPORT(add_rows);
HWY_EXPORT(add_columns);
HWY_EXPORT(lanes_of_sums);

constexpr int kRadius = 3;  // pixels

int mirrored(int i, int size) {
  return i < 0 ? -i : i < size ? i : 2 * size - 2 - i;
}

// Mirrors three columns of the row to either side.
void mirror_sides(std::uint16_t* sums, std::size_t width) {
  std::uint16_t* const first = sums + kRadius;
  std::uint16_t* const last = first + width - 1;
  for (int i = 1; i <= kRadius; ++i) {
    first[-i] = first[i];
    last[i] = last[-i];
  }
}

}  // namespace

void gaussian_blur(const cv::Mat& image, cv::Mat& blurred) {
  assert(image.type() == CV_8U && std::min(image.cols, image.rows) > kRadius && image.data != blurred.data);
  const auto width = static_cast<std::size_t>(image.cols);
  if (width < HWY_DYNAMIC_DISPATCH(lanes_of_sums)()) {
    cv::GaussianBlur(image, blurred, cv::Size(2 * kRadius + 1, 2 * kRadius + 1), 2.0, 2.0, cv::BORDER_REFLECT_101);
    return;
  }
  blurred.create(image.size(), CV_8U);
  constexpr std::size_t kBeyond = 64;  // read but not used
  ScratchVector<std::uint16_t> sums(width + 2 * kRadius + kBeyond, 0);
  for (int y = 0; y < image.rows; ++y) {
    std::array<const std::uint8_t*, 2 * kRadius + 1> rows;
    for (int i = -kRadius; i <= kRadius; ++i) {
      rows[static_cast<std::size_t>(i + kRadius)] = image.ptr<std::uint8_t>(mirrored(y + i, image.rows));
    }
    HWY_DYNAMIC_DISPATCH(add_rows)(rows.data(), width, sums.data() + kRadius);
    mirror_sides(sums.data(), width);
    HWY_DYNAMIC_DISPATCH(add_columns)(sums.data(), width, blurred.ptr<std::uint8_t>(y));
  }
}

}  // namespace byre

#endif
