#pragma once

#include "byre/features.h"

#include <array>
#include <cstdint>
#include <optional>

#include <Eigen/Core>

namespace byre {

// What values of a map are rounded to in its file, far below their noise (docs/map_format.md, "Quanta"). Each has a
// code of few bytes, and a value that was read has the code it was read from: what is read is written again byte by
// byte.

// A coordinate of a pixel in an image so many pixels wide or high, in 64ths of a pixel from the image's edge on.
// Rounded down to the middle of its quantum, so that a keypoint stays in the cell of its grid.
std::uint32_t pixel_code(float coordinate, int size);
float coordinate_of(std::uint32_t code);
constexpr std::uint32_t pixel_codes(int size) {  // codes are smaller than this, which stands for none
  return static_cast<std::uint32_t>(size) * 64;
}

// How far a measurement lies from its keypoint, along an axis: 128ths of a pixel, odd numbers for what lies above.
std::uint32_t offset_code(float offset);
float offset_of(std::uint32_t code);
inline constexpr std::uint32_t kLargestOffsetCode = 1u << 22;  // greater ones stand for none

// A standard deviation in pixels, 2^-8 to 2^8, in steps of 4.4 %; zero for what is none.
std::uint8_t sigma_code(float sigma);
float sigma_of_code(std::uint8_t code);

// Numbers with fewer digits, in the highest bytes of theirs: 16 binary digits, 8 of them, and 37.
std::uint32_t float24_code(float value);
float float_of_24(std::uint32_t code);
std::uint16_t float16_code(float value);
float float_of_16(std::uint16_t code);
std::uint64_t double48_code(double value);
double double_of_48(std::uint64_t code);

// The coordinates of a direction of unit length, 32767ths; zeros for what is none.
using DirectionCode = std::array<std::int16_t, 3>;
DirectionCode direction_code(const Eigen::Vector3f& direction);
Eigen::Vector3f direction_of(const DirectionCode& code);

// A lower triangular matrix whose product with its transpose is the covariance, row after row, in units of 2^exponent.
// So what is read is a covariance, however it was rounded.
struct CovarianceCode {
  std::array<std::int16_t, 6> factor{};
  std::int8_t exponent = kLeastExponent;
  static constexpr std::int8_t kLeastExponent = -128;
  bool operator==(const CovarianceCode&) const = default;
};
CovarianceCode covariance_code(const Eigen::Matrix3d& covariance);
// Empty for a code that no covariance has.
std::optional<Eigen::Matrix3d> covariance_of(const CovarianceCode& code);

// Sixteen grey values, evenly from the darkest to the brightest one of the patch: the lower four bits of a byte first.
struct PatchCode {
  std::uint8_t darkest = 0;
  std::uint8_t brightest = 0;
  std::array<std::uint8_t, Patch::kSize * Patch::kSize / 2> steps{};
  std::array<std::uint16_t, 2> centre{};  // 4096ths of an octave pixel
  bool operator==(const PatchCode&) const = default;
};
PatchCode patch_code(const Patch& patch);
// Empty for a code that no patch has.
std::optional<Patch> patch_of(const PatchCode& code);

}  // namespace byre
