#include "byre/features/descriptor.h"

#include "byre/features/brief_pattern.h"

#include <array>
#include <cmath>

// The vectorised part of this file is compiled once for each instruction set that supports arrays of vectors.
#define HWY_DISABLED_TARGETS (HWY_SVE | HWY_SVE2 | HWY_SVE_256 | HWY_SVE2_128 | HWY_RVV)
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "byre/features/descriptor.cc"
#include <hwy/foreach_target.h>
// After foreach_target.h.
#include "byre/features/pairwise_sums-inl.h"

HWY_BEFORE_NAMESPACE();
namespace byre::HWY_NAMESPACE {
namespace {

constexpr std::size_t kPairs = 256;

// Adds up rows of 32 pixels, weighted by column and by row.
void add_moments(const std::uint8_t* pixels, std::ptrdiff_t stride, int rows, const std::int16_t* by_column,
                 const std::int16_t* by_row, int* moments) {
  constexpr std::size_t kColumns = 32;
  const hn::CappedTag<std::int16_t, 16> d16;
  const hn::Rebind<std::uint8_t, decltype(d16)> d8;
  const hn::RepartitionToWide<decltype(d16)> d32;
  auto x = hn::Zero(d32), more_x = hn::Zero(d32), y = hn::Zero(d32), more_y = hn::Zero(d32);
  for (int row = 0; row < rows; ++row, pixels += stride, by_column += kColumns, by_row += kColumns) {
    for (std::size_t column = 0; column < kColumns; column += hn::Lanes(d16)) {
      const auto greys = hn::PromoteTo(d16, hn::LoadU(d8, pixels + column));
      x = hn::ReorderWidenMulAccumulate(d32, greys, hn::LoadU(d16, by_column + column), x, more_x);
      y = hn::ReorderWidenMulAccumulate(d32, greys, hn::LoadU(d16, by_row + column), y, more_y);
    }
  }
  moments[0] = hn::GetLane(hn::SumOfLanes(d32, hn::Add(x, more_x)));
  moments[1] = hn::GetLane(hn::SumOfLanes(d32, hn::Add(y, more_y)));
}

// Byte offsets of the rotated pattern's points from the pixel `before_middle` bytes before the centre.
void turn_pattern(const float* x, const float* y, float cosine, float sine, int stride, int before_middle,
                  std::uint32_t* offsets) {
  const hn::CappedTag<float, 16> d;
  const hn::RebindToSigned<decltype(d)> d32;
  const hn::RebindToUnsigned<decltype(d)> du32;
  const auto c = hn::Set(d, cosine), s = hn::Set(d, sine);
  const auto row_bytes = hn::Set(d32, stride), middle = hn::Set(d32, before_middle);
  for (std::size_t i = 0; i < 2 * kPairs; i += hn::Lanes(d)) {
    const auto at_x = hn::LoadU(d, x + i), at_y = hn::LoadU(d, y + i);
    const auto column = hn::NearestInt(hn::Sub(hn::Mul(at_x, c), hn::Mul(at_y, s)));
    const auto row = hn::NearestInt(hn::Add(hn::Mul(at_x, s), hn::Mul(at_y, c)));
    const auto offset = hn::Add(hn::Add(hn::Mul(row, row_bytes), column), middle);
    hn::StoreU(hn::BitCast(du32, offset), du32, offsets + i);
  }
}

// One bit per pair: whether the first is darker.
void compare_pairs(const std::uint8_t* first, const std::uint8_t* second, std::uint64_t* words) {
  const hn::CappedTag<std::uint8_t, 64> d;
  std::uint8_t bits[kPairs / 8 + 8];
  for (std::size_t i = 0; i < kPairs; i += hn::Lanes(d)) {
    hn::StoreMaskBits(d, hn::Lt(hn::LoadU(d, first + i), hn::LoadU(d, second + i)), bits + i / 8);
  }
  for (std::size_t word = 0; word < kPairs / 64; ++word) {
    words[word] = 0;
    for (std::size_t byte = 0; byte < 8; ++byte) words[word] |= std::uint64_t{bits[8 * word + byte]} << (8 * byte);
  }
}

}  // namespace
}  // namespace byre::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE

namespace byre {
namespace {

HWY_EXPORT(add_moments);
HWY_EXPORT(turn_pattern);
HWY_EXPORT(compare_pairs);

constexpr int kDiscRadius = 15;

// Half-widths of the disc's rows, symmetric about the diagonal.
std::array<int, kDiscRadius + 1> disc_rows() {
  std::array<int, kDiscRadius + 1> half_width{};
  const int diagonal = static_cast<int>(std::floor(kDiscRadius * std::sqrt(0.5) + 1.0));
  for (int row = 0; row <= diagonal; ++row) {
    half_width[static_cast<std::size_t>(row)] =
        static_cast<int>(std::lround(std::sqrt(double(kDiscRadius * kDiscRadius - row * row))));
  }
  int width = 0;
  for (int row = kDiscRadius; row >= static_cast<int>(std::ceil(kDiscRadius * std::sqrt(0.5))); --row) {
    while (half_width[static_cast<std::size_t>(width)] == half_width[static_cast<std::size_t>(width + 1)]) ++width;
    half_width[static_cast<std::size_t>(row)] = width++;
  }
  return half_width;
}

// Weights of the pixels of a square in the disc's moments; zero outside the disc. Rows are as wide as vector registers.
struct DiscWeights {
  static constexpr int kRows = 2 * kDiscRadius + 1;
  static constexpr int kColumns = 2 * kDiscRadius + 2;

  std::array<std::int16_t, std::size_t{kRows * kColumns}> x{};
  std::array<std::int16_t, std::size_t{kRows * kColumns}> y{};
};

DiscWeights disc_weights() {
  const std::array<int, kDiscRadius + 1> half_width = disc_rows();
  DiscWeights weights;
  for (int row = -kDiscRadius; row <= kDiscRadius; ++row) {
    const int width = half_width[static_cast<std::size_t>(std::abs(row))];
    for (int column = -width; column <= width; ++column) {
      const auto at = static_cast<std::size_t>((row + kDiscRadius) * DiscWeights::kColumns + column + kDiscRadius);
      weights.x[at] = static_cast<std::int16_t>(column);
      weights.y[at] = static_cast<std::int16_t>(row);
    }
  }
  return weights;
}

// The pattern's points by coordinate: first the first points of all pairs, then the second points.
struct PatternColumns {
  std::array<float, 512> x;
  std::array<float, 512> y;
};

PatternColumns split_pattern() {
  PatternColumns columns;
  for (std::size_t pair = 0; pair < 256; ++pair) {
    for (std::size_t point = 0; point < 2; ++point) {
      columns.x[256 * point + pair] = kBriefPattern[4 * pair + 2 * point];
      columns.y[256 * point + pair] = kBriefPattern[4 * pair + 2 * point + 1];
    }
  }
  return columns;
}

}  // namespace

float orientation(const std::uint8_t* centre, std::ptrdiff_t stride) {
  static const DiscWeights weights = disc_weights();
  int moments[2];
  HWY_DYNAMIC_DISPATCH(add_moments)
  (centre - kDiscRadius * stride - kDiscRadius, stride, DiscWeights::kRows, weights.x.data(), weights.y.data(),
   moments);
  return std::atan2(static_cast<float>(moments[1]), static_cast<float>(moments[0]));
}

Descriptor describe(const std::uint8_t* blurred_centre, std::ptrdiff_t stride, float angle) {
  static const PatternColumns pattern = split_pattern();
  const int before_middle = kDescriptorRadius * static_cast<int>(stride) + kDescriptorRadius;
  std::array<std::uint32_t, 512> offsets;
  HWY_DYNAMIC_DISPATCH(turn_pattern)
  (pattern.x.data(), pattern.y.data(), std::cos(angle), std::sin(angle), static_cast<int>(stride), before_middle,
   offsets.data());
  const std::uint8_t* const first = blurred_centre - before_middle;
  std::array<std::uint8_t, 512> greys;
#pragma GCC unroll 8
  for (std::size_t i = 0; i < greys.size(); ++i) greys[i] = first[offsets[i]];
  Descriptor descriptor;
  HWY_DYNAMIC_DISPATCH(compare_pairs)(greys.data(), greys.data() + 256, descriptor.data());
  return descriptor;
}

}  // namespace byre

#endif
