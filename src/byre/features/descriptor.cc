#include "byre/features/descriptor.h"

#include "byre/features/brief_pattern.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>

namespace byre {
namespace {

constexpr int kDiscRadius = 15;

// Half-widths of the disc's rows, symmetric about the diagonal so that the sum is too.
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

// What each pixel of a square about the disc counts for in its moments; nothing outside the disc. Rows are as wide as
// vector registers.
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

// The pattern, split by coordinate so that the rotation vectorises.
struct PatternColumns {
  std::array<float, 512> x;
  std::array<float, 512> y;
};

PatternColumns split_pattern() {
  PatternColumns columns;
  for (std::size_t i = 0; i < 512; ++i) {
    columns.x[i] = kBriefPattern[2 * i];
    columns.y[i] = kBriefPattern[2 * i + 1];
  }
  return columns;
}

// Rounds half to even without a library call, for |value| < 2^22.
inline int round_to_int(float value) {
  constexpr float kMagic = 12582912.0f;  // 1.5 * 2^23: the sum's mantissa is the rounded value
  const float shifted = value + kMagic;
  std::int32_t bits;
  std::memcpy(&bits, &shifted, sizeof bits);
  return bits - 0x4B400000;
}

}  // namespace

float orientation(const std::uint8_t* centre, std::ptrdiff_t stride) {
  static const DiscWeights weights = disc_weights();
  std::array<std::uint8_t, weights.x.size()> square;
  const std::uint8_t* row = centre - kDiscRadius * stride - kDiscRadius;
  for (std::size_t at = 0; at < square.size(); at += DiscWeights::kColumns, row += stride) {
    std::copy_n(row, DiscWeights::kColumns, square.data() + at);
  }
  int moment_x = 0;
  int moment_y = 0;
  for (std::size_t i = 0; i < square.size(); ++i) {
    const auto pixel = static_cast<std::int16_t>(square[i]);
    moment_x += pixel * weights.x[i];
    moment_y += pixel * weights.y[i];
  }
  return std::atan2(static_cast<float>(moment_y), static_cast<float>(moment_x));
}

Descriptor describe(const std::uint8_t* blurred_centre, std::ptrdiff_t stride, float angle) {
  static const PatternColumns pattern = split_pattern();
  const float cosine = std::cos(angle);
  const float sine = std::sin(angle);
  const int row_stride = static_cast<int>(stride);
  std::array<int, 512> offset;
  for (std::size_t i = 0; i < 512; ++i) {
    const int column = round_to_int(pattern.x[i] * cosine - pattern.y[i] * sine);
    const int row = round_to_int(pattern.x[i] * sine + pattern.y[i] * cosine);
    offset[i] = row * row_stride + column;
  }
  Descriptor descriptor{};
  for (std::size_t word = 0; word < 4; ++word) {
    std::uint64_t bits = 0;
    for (std::size_t bit = 0; bit < 64; ++bit) {
      const std::size_t pair = 2 * (64 * word + bit);
      bits |= static_cast<std::uint64_t>(blurred_centre[offset[pair]] < blurred_centre[offset[pair + 1]]) << bit;
    }
    descriptor[word] = bits;
  }
  return descriptor;
}

}  // namespace byre
