#include "byre/camera/exposure.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <numeric>

namespace byre {
namespace {

constexpr int kGridColumns = 8;
constexpr int kGridRows = 6;
constexpr int kStep = 2;  // pixels between sampled pixels, both ways

// Shim's curve of a gradient, from 0 to 1: zero below the noise threshold, and flat for strong gradients.
double information_of(double gradient) {
  constexpr double kThreshold = 0.06;
  constexpr double kLambda = 1e3;
  if (gradient < kThreshold) return 0.0;
  static const double scale = std::log(kLambda * (1.0 - kThreshold) + 1.0);
  return std::log(kLambda * (gradient - kThreshold) + 1.0) / scale;
}

// Information by the difference of grey values.
std::array<float, 256> information_table() {
  std::array<float, 256> table{};
  for (std::size_t i = 0; i < table.size(); ++i) {
    table[i] = static_cast<float>(information_of(static_cast<double>(i) / 255.0));
  }
  return table;
}

constexpr std::uint8_t kFull = 251;  // grey value from which a pixel counts as saturated
constexpr int kNoise = 4;            // grey values: smaller gradients count as zero at any exposure

// Predicted grey values for an exposure factor.
std::array<std::uint8_t, 256> values_with(double factor) {
  std::array<std::uint8_t, 256> values{};
  for (std::size_t i = 0; i < values.size(); ++i) {
    const double value = i >= kFull ? 255.0 : std::min(255.0, factor * static_cast<double>(i));
    values[i] = static_cast<std::uint8_t>(std::lround(value));
  }
  return values;
}

// Without gradients, only a nearly black or nearly white image indicates a direction.
double factor_of_blank(const Image& image) {
  constexpr double kMuch = 2.0;
  constexpr double kDark = 32.0, kBright = 223.0;  // mean grey values
  const double mean = std::accumulate(image.pixels.begin(), image.pixels.end(), 0.0) /
                      static_cast<double>(std::max<std::size_t>(1, image.pixels.size()));
  if (mean > kBright) return 1.0 / kMuch;
  return mean < kDark ? kMuch : 1.0;
}

}  // namespace

double corner_information(const Image& image, double factor) {
  static const std::array<float, 256> information = information_table();
  const std::array<std::uint8_t, 256> values = values_with(factor);
  std::array<double, kGridColumns * kGridRows> sums{};
  const auto index = [&](int x, int y) {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(image.width) + static_cast<std::size_t>(x);
  };
  const auto gradient = [&](std::uint8_t a, std::uint8_t b) {
    return std::abs(int{a} - int{b}) < kNoise ? 0 : std::abs(int{values[a]} - int{values[b]});
  };
  for (int y = 0; y + kStep < image.height; y += kStep) {
    const int row = y * kGridRows / image.height;
    for (int x = 0; x + kStep < image.width; x += kStep) {
      const std::uint8_t here = image.pixels[index(x, y)];
      const int steepest = std::max(gradient(here, image.pixels[index(x + kStep, y)]),
                                    gradient(here, image.pixels[index(x, y + kStep)]));
      sums[static_cast<std::size_t>(row * kGridColumns + x * kGridColumns / image.width)] +=
          information[static_cast<std::size_t>(steepest)];
    }
  }
  double total = 0.0;
  for (const double sum : sums) total += std::log1p(sum);
  return total;
}

double best_exposure_factor(const Image& image) {
  constexpr std::array kFactors = {1.0, 1.0 / 1.1, 1.1, 1.0 / 1.3, 1.3, 1.0 / 1.7, 1.7, 1.0 / 2.3, 2.3, 4.0, 8.0};
  constexpr double kClearly = 1.003;  // ignores insignificant improvements
  constexpr double kNothing = 1.0;
  double best = kFactors.front();
  double most = kClearly * corner_information(image, best);
  for (const double factor : kFactors) {
    const double information = corner_information(image, factor);
    if (information <= most) continue;
    most = information;
    best = factor;
  }
  return most < kNothing ? factor_of_blank(image) : best;
}

CameraExposure next_exposure(const CameraExposure& now, double factor, const CameraExposureLimits& limits) {
  constexpr double kShare = 0.7;  // share of the step, in the logarithm
  constexpr double kMax = 2.0;
  const double change = std::clamp(std::pow(factor, kShare), 1.0 / kMax, kMax);
  const double light = std::max(now.light(), limits.min_seconds) * change;
  CameraExposure next;
  next.seconds = std::clamp(light, limits.min_seconds, limits.max_seconds);
  next.gain = std::clamp(light / next.seconds, 1.0, std::max(1.0, limits.max_gain));
  return next;
}

}  // namespace byre
