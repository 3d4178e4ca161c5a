#pragma once

#include "byre/features.h"

#include <array>
#include <cstdint>
#include <optional>

#include <Eigen/Core>

namespace byre {

// Quantisation of a map's values in its file, far below their noise (docs/lab/map_file.md, "Rounding"). Each
// value has a code of few bytes. Coding a decoded value gives the same code.

// Pixel coordinate in an image of given width or height, in 64ths of a pixel from the image's edge. Decoded to the
// middle of its quantum, so that a keypoint stays in its grid cell.
std::uint32_t pixel_code(float coordinate, int size);
float coordinate_of(std::uint32_t code);
constexpr std::uint32_t pixel_codes(int size) {  // codes are smaller than this, which means none
  return static_cast<std::uint32_t>(size) * 64;
}

// Offset of a measurement from its keypoint along an axis: 128ths of a pixel, odd codes for positive offsets.
std::uint32_t offset_code(float offset);
float offset_of(std::uint32_t code);
inline constexpr std::uint32_t kLargestOffsetCode = 1u << 22;  // greater codes mean none

// Standard deviation in pixels, 2^-8 to 2^8 in steps of 4.4 %; zero means none.
std::uint8_t sigma_code(float sigma);
float sigma_of_code(std::uint8_t code);

// Floating-point numbers reduced to their highest bytes, with 16, 8 and 37 significant bits.
std::uint32_t float24_code(float value);
float float_of_24(std::uint32_t code);
std::uint16_t float16_code(float value);
float float_of_16(std::uint16_t code);
std::uint64_t double48_code(double value);
double double_of_48(std::uint64_t code);

// Direction of unit length, coordinates in 32767ths; zeros mean none.
using DirectionCode = std::array<std::int16_t, 3>;
DirectionCode direction_code(const Eigen::Vector3f& direction);
Eigen::Vector3f direction_of(const DirectionCode& code);

// Lower triangular factor of the covariance, row by row, in units of 2^exponent; valid however it is rounded.
struct CovarianceCode {
  std::array<std::int16_t, 6> factor{};
  std::int8_t exponent = kLeastExponent;
  static constexpr std::int8_t kLeastExponent = -128;
  bool operator==(const CovarianceCode&) const = default;
};
CovarianceCode covariance_code(const Eigen::Matrix3d& covariance);
// Empty for an invalid code.
std::optional<Eigen::Matrix3d> covariance_of(const CovarianceCode& code);

// Sixteen grey levels evenly spaced from the darkest to the brightest of the patch; the low half of a byte comes first.
struct PatchCode {
  std::uint8_t darkest = 0;
  std::uint8_t brightest = 0;
  std::array<std::uint8_t, Patch::kSize * Patch::kSize / 2> steps{};
  std::array<std::uint16_t, 2> centre{};  // 4096ths of an octave pixel
  bool operator==(const PatchCode&) const = default;
};
PatchCode patch_code(const Patch& patch);
// Empty for an invalid code.
std::optional<Patch> patch_of(const PatchCode& code);

}  // namespace byre
