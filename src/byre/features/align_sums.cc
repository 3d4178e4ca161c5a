#include "byre/features/align_sums.h"

#include <algorithm>
#include <cassert>

// The vectorised part of this file is compiled once for each instruction set. Sums always use eight lanes, so that they
// do not depend on the vector length.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "byre/features/align_sums.cc"
#include <hwy/foreach_target.h>
// After foreach_target.h.
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace byre::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

constexpr int kLanes = 8;
using D = hn::CappedTag<float, kLanes>;

// Sum of make(index) over vectors, in eight lanes.
template <int Count, typename Make>
HWY_INLINE float sum_of(Make make) {
  const D d;
  HWY_ALIGN float sums[kLanes];
  for (int lane = 0; lane < kLanes; lane += static_cast<int>(hn::Lanes(d))) {
    auto sum = make(lane);
    for (int i = kLanes; i < Count; i += kLanes) sum = hn::Add(sum, make(i + lane));
    hn::StoreU(sum, d, sums + lane);
  }
  return ((sums[0] + sums[1]) + (sums[2] + sums[3])) + ((sums[4] + sums[5]) + (sums[6] + sums[7]));
}

template <int Count>
HWY_INLINE float dot(const float* a, const float* b) {
  const D d;
  return sum_of<Count>([=](int i) { return hn::Mul(hn::LoadU(d, a + i), hn::LoadU(d, b + i)); });
}

// Subtracts the mean from the first Count numbers; the padding stays zero.
template <int Count>
HWY_INLINE void centre(float* values) {
  const D d;
  constexpr int kPadded = static_cast<int>(padded(Count));
  const float mean = sum_of<kPadded>([=](int i) { return hn::LoadU(d, values + i); }) / Count;
  for (int i = 0; i < kPadded; i += static_cast<int>(hn::Lanes(d))) {
    hn::StoreU(hn::Sub(hn::LoadU(d, values + i), hn::Set(d, mean)), d, values + i);
  }
  for (int i = Count; i < kPadded; ++i) values[i] = 0.0f;
}

template <int Size>
HWY_INLINE void sum_up(const float* centred_template, float sum_of_squares, const float* around, AlignSums& sums) {
  constexpr int kCount = Size * Size, kPadded = static_cast<int>(padded(kCount)), kStride = Size + 2;
  const D d;
  HWY_ALIGN float grey[kPadded], x[kPadded], y[kPadded], residual[kPadded];
  const auto half = hn::Set(d, 0.5f);
  for (int row = 0; row < Size; ++row) {
    // The last eight of a row overlap with the first, to stay inside the row.
    for (int first = 0; first <= Size - kLanes; first += Size == kLanes ? kLanes : Size - kLanes) {
      for (int lane = 0; lane < kLanes; lane += static_cast<int>(hn::Lanes(d))) {
        const float* const at = around + (row + 1) * kStride + 1 + first + lane;
        const int i = row * Size + first + lane;
        hn::StoreU(hn::LoadU(d, at), d, grey + i);
        hn::StoreU(hn::Mul(half, hn::Sub(hn::LoadU(d, at + 1), hn::LoadU(d, at - 1))), d, x + i);
        hn::StoreU(hn::Mul(half, hn::Sub(hn::LoadU(d, at + kStride), hn::LoadU(d, at - kStride))), d, y + i);
      }
    }
  }
  for (int i = kCount; i < kPadded; ++i) grey[i] = x[i] = y[i] = 0.0f;
  centre<kCount>(grey);
  centre<kCount>(x);
  centre<kCount>(y);
  sums.product = dot<kPadded>(grey, centred_template);
  sums.squares = dot<kPadded>(grey, grey);
  const auto gain = hn::Set(d, sums.product / sum_of_squares);
  for (int i = 0; i < kPadded; i += static_cast<int>(hn::Lanes(d))) {
    hn::StoreU(hn::Sub(hn::LoadU(d, grey + i), hn::Mul(gain, hn::LoadU(d, centred_template + i))), d, residual + i);
  }
  sums.xx = dot<kPadded>(x, x);
  sums.xy = dot<kPadded>(x, y);
  sums.yy = dot<kPadded>(y, y);
  sums.x_residual = dot<kPadded>(x, residual);
  sums.y_residual = dot<kPadded>(y, residual);
  sums.residual_squares = dot<kPadded>(residual, residual);
}

void sum_up_8(const float* centred_template, float sum_of_squares, const float* around, AlignSums& sums) {
  sum_up<8>(centred_template, sum_of_squares, around, sums);
}
void sum_up_10(const float* centred_template, float sum_of_squares, const float* around, AlignSums& sums) {
  sum_up<10>(centred_template, sum_of_squares, around, sums);
}

float centre_8(float* values) {
  centre<64>(values);
  return dot<padded(64)>(values, values);
}
float centre_10(float* values) {
  centre<100>(values);
  return dot<padded(100)>(values, values);
}

void warp(const std::uint8_t* pixels, const WarpGrid& places, float* values) {
  constexpr int kSide = 16;  // pixels
  const D d;
  const hn::Rebind<std::int32_t, D> d32;
  const auto low_byte = hn::Set(d32, 0xff);
  // Gathers read two bytes more than are used.
  HWY_ALIGN std::uint8_t read[kSide * kSide + 2] = {};
  std::copy_n(pixels, kSide * kSide, read);
  const auto* const from = reinterpret_cast<const std::int32_t*>(read);
  const auto between_columns = [&](auto offset, auto fraction) {
    const auto bytes = hn::GatherOffset(d32, from, offset);
    const auto left = hn::And(bytes, low_byte), right = hn::And(hn::ShiftRight<8>(bytes), low_byte);
    return hn::Add(hn::ConvertTo(d, left), hn::Mul(fraction, hn::ConvertTo(d, hn::Sub(right, left))));
  };
  for (int row = 0; row < kLanes; ++row) {
    const auto down = static_cast<float>(row);
    const auto row_x = hn::Set(d, places.x + down * places.x_along_column);
    const auto row_y = hn::Set(d, places.y + down * places.y_along_column);
    for (int lane = 0; lane < kLanes; lane += static_cast<int>(hn::Lanes(d))) {
      const auto steps = hn::Iota(d, static_cast<float>(lane));
      const auto x = hn::Add(row_x, hn::Mul(steps, hn::Set(d, places.x_along_row)));
      const auto y = hn::Add(row_y, hn::Mul(steps, hn::Set(d, places.y_along_row)));
      const auto whole_x = hn::ConvertTo(d32, x), whole_y = hn::ConvertTo(d32, y);
      const auto right_share = hn::Sub(x, hn::ConvertTo(d, whole_x)),
                 lower_share = hn::Sub(y, hn::ConvertTo(d, whole_y));
      const auto offset = hn::Add(hn::ShiftLeft<4>(whole_y), whole_x);
      const auto upper = between_columns(offset, right_share);
      const auto lower = between_columns(hn::Add(offset, hn::Set(d32, kSide)), right_share);
      hn::StoreU(hn::Add(upper, hn::Mul(lower_share, hn::Sub(lower, upper))), d, values + row * kLanes + lane);
    }
  }
}

// Interpolates eight columns, beginning at `first`, of all rows.
HWY_INLINE void interpolate_columns(const std::uint8_t* pixels, std::ptrdiff_t stride, float right, float below,
                                    int size, float* values) {
  const D d;
  const hn::Rebind<std::int32_t, D> d32;
  const hn::Rebind<std::uint8_t, D> d8;
  const auto left_share = hn::Set(d, 1.0f - right), right_share = hn::Set(d, right);
  const auto upper_share = hn::Set(d, 1.0f - below), lower_share = hn::Set(d, below);
  for (int lane = 0; lane < kLanes; lane += static_cast<int>(hn::Lanes(d))) {
    const auto between_columns = [&](int row) {
      const std::uint8_t* const at = pixels + row * stride + lane;
      const auto left = hn::ConvertTo(d, hn::PromoteTo(d32, hn::LoadU(d8, at)));
      const auto beside = hn::ConvertTo(d, hn::PromoteTo(d32, hn::LoadU(d8, at + 1)));
      return hn::Add(hn::Mul(left_share, left), hn::Mul(right_share, beside));
    };
    auto upper = between_columns(0);
    for (int row = 0; row < size; ++row) {
      const auto lower = between_columns(row + 1);
      hn::StoreU(hn::Add(hn::Mul(upper_share, upper), hn::Mul(lower_share, lower)), d, values + row * size + lane);
      upper = lower;
    }
  }
}

void interpolate(const std::uint8_t* pixels, std::ptrdiff_t stride, float right, float below, int size, float* values) {
  interpolate_columns(pixels, stride, right, below, size, values);
  // The last eight columns overlap with the first.
  const int last = size - kLanes;
  if (last > 0) interpolate_columns(pixels + last, stride, right, below, size, values + last);
}

}  // namespace
}  // namespace byre::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE

namespace byre {
namespace {

HWY_EXPORT(sum_up_8);
HWY_EXPORT(sum_up_10);
HWY_EXPORT(centre_8);
HWY_EXPORT(centre_10);
HWY_EXPORT(warp);
HWY_EXPORT(interpolate);

}  // namespace

AlignSums align_sums(const float* centred_template, float sum_of_squares, const float* around, int size) {
  assert(size == 8 || size == 10);
  AlignSums sums;
  size == 8 ? HWY_DYNAMIC_DISPATCH(sum_up_8)(centred_template, sum_of_squares, around, sums)
            : HWY_DYNAMIC_DISPATCH(sum_up_10)(centred_template, sum_of_squares, around, sums);
  return sums;
}

float centre_template(float* values, int size) {
  assert(size == 8 || size == 10);
  return size == 8 ? HWY_DYNAMIC_DISPATCH(centre_8)(values) : HWY_DYNAMIC_DISPATCH(centre_10)(values);
}

void warp_square(const std::uint8_t* pixels, const WarpGrid& places, float* values) {
  HWY_DYNAMIC_DISPATCH(warp)(pixels, places, values);
}

void interpolate_square(const std::uint8_t* pixels, std::ptrdiff_t stride, float right, float below, int size,
                        float* values) {
  assert(size >= 8 && size <= 16);
  HWY_DYNAMIC_DISPATCH(interpolate)(pixels, stride, right, below, size, values);
}

}  // namespace byre

#endif
