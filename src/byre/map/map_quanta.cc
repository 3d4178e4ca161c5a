#include "byre/map/map_quanta.h"

#include "byre/map/map_values.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace byre {
namespace {

constexpr double kPixelCodes = 64.0;    // per pixel
constexpr float kOffsetCodes = 128.0f;  // per pixel
constexpr int kSigmaCodes = 16;         // per octave
constexpr int kCodeOfOnePixel = 128;
constexpr float kDirectionCodes = 32767.0f;
constexpr float kCentreCodes = 4096.0f;  // per octave pixel
constexpr float kLargestCentre = kCentreCodes * (Patch::kSize - 1);
constexpr long kNoCentre = 0xffff;

std::array<float, 256> sigmas_of_codes() {
  std::array<float, 256> sigmas;
  sigmas[0] = 0.0f;
  for (int code = 1; code < 256; ++code) {
    sigmas[static_cast<std::size_t>(code)] =
        static_cast<float>(std::exp2(static_cast<double>(code - kCodeOfOnePixel) / kSigmaCodes));
  }
  return sigmas;
}

// Drops the lowest bits, rounding to nearest. Finite values stay finite, others stay non-finite.
std::uint32_t rounded_float(float value, int dropped_bits) {
  const auto bits = std::bit_cast<std::uint32_t>(value);
  const std::uint32_t half = 1u << (dropped_bits - 1);
  const std::uint32_t rounded = (bits + half) >> dropped_bits;
  const bool stays_finite = std::isfinite(value) && std::isfinite(std::bit_cast<float>(rounded << dropped_bits));
  return stays_finite ? rounded : bits >> dropped_bits;
}

DirectionCode rounded_direction(const Eigen::Vector3f& direction) {
  DirectionCode code;
  for (int axis = 0; axis < 3; ++axis) {
    const float rounded = std::clamp(std::round(direction[axis] * kDirectionCodes), -kDirectionCodes, kDirectionCodes);
    code[static_cast<std::size_t>(axis)] = static_cast<std::int16_t>(rounded);
  }
  return code;
}

constexpr int kFactorBits = 15;  // bits of the largest entry of a factor

// Cholesky factor. Directions without a positive variance have zeros in the factor.
std::array<double, 6> factor_of(const Eigen::Matrix3d& c) {
  const auto pivot = [](double variance) { return variance > 0.0 ? std::sqrt(variance) : 0.0; };
  const auto over = [](double value, double divisor) {
    const double quotient = divisor > 0.0 ? value / divisor : 0.0;
    return std::isfinite(quotient) ? quotient : 0.0;
  };
  const double l00 = pivot(c(0, 0));
  const double l10 = over(c(1, 0), l00), l20 = over(c(2, 0), l00);
  const double l11 = pivot(c(1, 1) - l10 * l10);
  const double l21 = over(c(2, 1) - l20 * l10, l11);
  const double l22 = pivot(c(2, 2) - l20 * l20 - l21 * l21);
  return {l00, l10, l11, l20, l21, l22};
}

constexpr std::array<bool, 6> kIsPivot = {true, false, true, false, false, true};

// Entries in units of 2^exponent; non-zero pivots stay non-zero.
std::array<long, 6> rounded_factor(const std::array<double, 6>& factor, int exponent) {
  std::array<long, 6> rounded;
  for (std::size_t i = 0; i < 6; ++i) {
    rounded[i] = std::lround(std::clamp(std::ldexp(factor[i], -exponent), -32767.0, 32768.0));
    if (kIsPivot[i] && factor[i] > 0.0) rounded[i] = std::max(rounded[i], 1L);
  }
  return rounded;
}

bool is_covariance_code(const CovarianceCode& code) {
  const auto& l = code.factor;
  const bool has_pivots = l[0] >= 0 && l[2] >= 0 && l[5] >= 0;
  const bool is_empty_without = (l[0] > 0 || (l[1] == 0 && l[3] == 0)) && (l[2] > 0 || l[4] == 0);
  int greatest = 0;
  for (const int entry : l) greatest = std::max(greatest, std::abs(entry));
  const bool is_shortest = greatest >= 1 << (kFactorBits - 1) || code.exponent == CovarianceCode::kLeastExponent;
  return has_pivots && is_empty_without && is_shortest && greatest < 1 << kFactorBits;
}

constexpr int kSteps = 15;  // from the darkest grey value to the brightest

int grey_of_step(int step, int darkest, int range) {
  return darkest + (2 * step * range + kSteps) / (2 * kSteps);
}
int step_of_grey(int grey, int darkest, int range) {
  return range == 0 ? 0 : (2 * (grey - darkest) * kSteps + range) / (2 * range);
}

// Bit set of the steps possible in a patch of this range: those that are nearest to some grey value.
std::uint32_t proper_steps(int range) {
  std::uint32_t proper = 0;
  for (int step = 0; step <= kSteps; ++step) {
    if (step_of_grey(grey_of_step(step, 0, range), 0, range) == step) proper |= 1u << step;
  }
  return proper;
}

constexpr int kLeastFullRange = kSteps;  // ranges from here on use all steps

using Steps = std::array<std::uint8_t, Patch::kSize * Patch::kSize>;

bool are_proper(const Steps& steps, int range) {
  if (range >= kLeastFullRange) return true;
  std::uint32_t seen = 0;
  for (const std::uint8_t step : steps) seen |= 1u << step;
  return (seen & ~proper_steps(range)) == 0;
}

}  // namespace

// In double, so that rounding does not cross a boundary between two quanta.
std::uint32_t pixel_code(float coordinate, int size) {
  const double from_edge = static_cast<double>(coordinate) + 0.5;
  if (!(from_edge >= 0.0 && from_edge <= size)) return pixel_codes(size);
  return std::min(static_cast<std::uint32_t>(from_edge * kPixelCodes), pixel_codes(size) - 1);
}

float coordinate_of(std::uint32_t code) {
  return static_cast<float>((static_cast<double>(code) + 0.5) / kPixelCodes - 0.5);
}

std::uint32_t offset_code(float offset) {
  constexpr float kLargest = static_cast<float>(kLargestOffsetCode / 2);
  if (!std::isfinite(offset)) return kLargestOffsetCode + 1;
  const long steps = std::lround(std::clamp(offset * kOffsetCodes, -kLargest, kLargest));
  return static_cast<std::uint32_t>(steps > 0 ? 2 * steps - 1 : -2 * steps);
}

float offset_of(std::uint32_t code) {
  const auto steps = static_cast<float>((code + 1) / 2);
  return (code % 2 == 1 ? steps : -steps) / kOffsetCodes;
}

std::uint8_t sigma_code(float sigma) {
  if (!(sigma > 0.0f && std::isfinite(sigma))) return 0;
  const long code = std::lround(std::log2(static_cast<double>(sigma)) * kSigmaCodes) + kCodeOfOnePixel;
  return static_cast<std::uint8_t>(std::clamp(code, 1L, 255L));
}

float sigma_of_code(std::uint8_t code) {
  static const std::array<float, 256> kSigmas = sigmas_of_codes();
  return kSigmas[code];
}

std::uint32_t float24_code(float value) {
  return rounded_float(value, 8);
}
float float_of_24(std::uint32_t code) {
  return std::bit_cast<float>(code << 8);
}

std::uint16_t float16_code(float value) {
  return static_cast<std::uint16_t>(rounded_float(value, 16));
}
float float_of_16(std::uint16_t code) {
  return std::bit_cast<float>(std::uint32_t{code} << 16);
}

std::uint64_t double48_code(double value) {
  return std::bit_cast<std::uint64_t>(value) >> 16;
}
double double_of_48(std::uint64_t code) {
  return std::bit_cast<double>(code << 16);
}

// Normalises a direction whose rounded length is off. A direction that was read is accurate enough and keeps its code.
DirectionCode direction_code(const Eigen::Vector3f& direction) {
  constexpr float kTolerance = 5e-4f;
  if (!is_unit(direction)) return {};
  const DirectionCode as_it_is = rounded_direction(direction);
  const bool is_near_enough = std::abs(direction_of(as_it_is).norm() - 1.0f) < kTolerance;
  return is_near_enough ? as_it_is : rounded_direction(direction.normalized());
}

Eigen::Vector3f direction_of(const DirectionCode& code) {
  return Eigen::Vector3f(code[0], code[1], code[2]) / kDirectionCodes;
}

// Entries are integers of 15 bits, so that products, sums, and the roots and quotients of the inverse are exact.
CovarianceCode covariance_code(const Eigen::Matrix3d& covariance) {
  if (!covariance.allFinite()) return {{-1}};
  const std::array<double, 6> factor = factor_of(covariance);
  double greatest = 0.0;
  for (const double entry : factor) greatest = std::max(greatest, std::abs(entry));
  int exponent = CovarianceCode::kLeastExponent;
  if (greatest > 0.0) exponent = std::clamp(std::ilogb(greatest) + 1 - kFactorBits, exponent, 127);
  std::array<long, 6> rounded = rounded_factor(factor, exponent);
  const auto is_too_great = [](long entry) { return std::abs(entry) >= 1L << kFactorBits; };
  if (std::ranges::any_of(rounded, is_too_great)) rounded = rounded_factor(factor, ++exponent);
  CovarianceCode code;
  std::ranges::transform(rounded, code.factor.begin(),
                         [](long entry) { return static_cast<std::int16_t>(std::min(entry, 32767L)); });
  code.exponent = static_cast<std::int8_t>(std::min(exponent, 127));
  return code;
}

std::optional<Eigen::Matrix3d> covariance_of(const CovarianceCode& code) {
  if (!is_covariance_code(code)) return std::nullopt;
  const auto& l = code.factor;
  Eigen::Matrix3d factor;
  factor << l[0], 0.0, 0.0, l[1], l[2], 0.0, l[3], l[4], l[5];
  const Eigen::Matrix3d product = factor * factor.transpose();
  return Eigen::Matrix3d(product * std::ldexp(1.0, 2 * code.exponent));
}

PatchCode patch_code(const Patch& patch) {
  const auto [darkest, brightest] = std::ranges::minmax(patch.pixels);
  PatchCode code{darkest, brightest, {}, {}};
  for (std::size_t i = 0; i < code.steps.size(); ++i) {
    const int low = step_of_grey(patch.pixels[2 * i], darkest, brightest - darkest);
    const int high = step_of_grey(patch.pixels[2 * i + 1], darkest, brightest - darkest);
    code.steps[i] = static_cast<std::uint8_t>(low | high << 4);
  }
  for (int axis = 0; axis < 2; ++axis) {
    const float place = patch.centre[axis] * kCentreCodes;
    const bool is_inside = place >= 0.0f && place <= kLargestCentre;
    code.centre[static_cast<std::size_t>(axis)] =
        static_cast<std::uint16_t>(is_inside ? std::lround(place) : kNoCentre);
  }
  return code;
}

// Plain loops over bytes, which the compiler vectorises.
std::optional<Patch> patch_of(const PatchCode& code) {
  const int range = code.brightest - code.darkest;
  if (range < 0) return std::nullopt;
  Steps steps;
  for (std::size_t i = 0; i < code.steps.size(); ++i) {
    steps[2 * i] = code.steps[i] & 15u;
    steps[2 * i + 1] = code.steps[i] >> 4;
  }
  std::uint8_t least = kSteps, greatest = 0;
  for (const std::uint8_t step : steps) {
    least = std::min(least, step);
    greatest = std::max(greatest, step);
  }
  if (least != 0 || greatest != (range == 0 ? 0 : kSteps) || !are_proper(steps, range)) return std::nullopt;
  std::optional<Patch> patch(std::in_place);
  const auto twice_range = static_cast<std::uint16_t>(2 * range);
  for (std::size_t i = 0; i < steps.size(); ++i) {
    const auto scaled = static_cast<std::uint16_t>(steps[i] * twice_range + kSteps);
    patch->pixels[i] = static_cast<std::uint8_t>(code.darkest + scaled / (2 * kSteps));
  }
  patch->centre << static_cast<float>(code.centre[0]) / kCentreCodes, static_cast<float>(code.centre[1]) / kCentreCodes;
  return patch;
}

}  // namespace byre
