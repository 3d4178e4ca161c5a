#include "byre/camera/exposure.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdlib>

namespace byre {
namespace {

constexpr int kGridColumns = 8;
constexpr int kGridRows = 6;
constexpr int kStep = 2;  // pixels from one that is looked at to the next, both ways

// Shim's curve of a gradient, from 0 to 1: none below the threshold, which noise exceeds, and flat for strong ones.
double information_of(double gradient) {
  constexpr double kThreshold = 0.06;
  constexpr double kLambda = 1e3;
  if (gradient < kThreshold) return 0.0;
  static const double scale = std::log(kLambda * (1.0 - kThreshold) + 1.0);
  return std::log(kLambda * (gradient - kThreshold) + 1.0) / scale;
}

// Information of differences of grey values, by their size.
std::array<float, 256> information_table() {
  std::array<float, 256> table{};
  for (std::size_t i = 0; i < table.size(); ++i) {
    table[i] = static_cast<float>(information_of(static_cast<double>(i) / 255.0));
  }
  return table;
}

std::array<std::uint8_t, 256> gamma_curve(double gamma) {
  std::array<std::uint8_t, 256> curve{};
  for (std::size_t i = 0; i < curve.size(); ++i) {
    curve[i] = static_cast<std::uint8_t>(std::lround(255.0 * std::pow(static_cast<double>(i) / 255.0, gamma)));
  }
  return curve;
}

// Where nothing is to be seen, no curve tells the way, but pixels that are full, or empty, do.
double gamma_of_blank(const Image& image) {
  constexpr std::uint8_t kEmpty = 4, kFull = 251;
  constexpr double kMuchBrighter = 0.5, kMuchDarker = 2.0;
  const auto full = std::ranges::count_if(image.pixels, [](std::uint8_t pixel) { return pixel >= kFull; });
  const auto empty = std::ranges::count_if(image.pixels, [](std::uint8_t pixel) { return pixel <= kEmpty; });
  const auto half = static_cast<std::ptrdiff_t>(image.pixels.size() / 2);
  if (full > half) return kMuchDarker;
  return empty > half ? kMuchBrighter : 1.0;
}

}  // namespace

double gradient_information(const Image& image, double gamma) {
  static const std::array<float, 256> information = information_table();
  const std::array<std::uint8_t, 256> curve = gamma_curve(gamma);
  std::array<double, kGridColumns * kGridRows> sums{};
  const auto value = [&](int x, int y) {
    return int{curve[image.pixels[static_cast<std::size_t>(y) * static_cast<std::size_t>(image.width) +
                                  static_cast<std::size_t>(x)]]};
  };
  for (int y = 0; y + kStep < image.height; y += kStep) {
    const int row = y * kGridRows / image.height;
    for (int x = 0; x + kStep < image.width; x += kStep) {
      const int here = value(x, y);
      const int steepest = std::max(std::abs(value(x + kStep, y) - here), std::abs(value(x, y + kStep) - here));
      sums[static_cast<std::size_t>(row * kGridColumns + x * kGridColumns / image.width)] +=
          information[static_cast<std::size_t>(steepest)];
    }
  }
  double total = 0.0;
  for (const double sum : sums) total += std::log1p(sum);
  return total;
}

double best_gamma(const Image& image) {
  constexpr std::array kGammas = {1.0, 1.0 / 1.2, 1.2, 1.0 / 1.5, 1.5, 1.0 / 1.9, 1.9, 1.0 / 2.6, 2.6};
  constexpr double kClearly = 1.002;  // a curve that is hardly better is no reason to change anything
  double best = kGammas.front();
  double most = kClearly * gradient_information(image, best);
  for (const double gamma : kGammas) {
    const double information = gradient_information(image, gamma);
    if (information <= most) continue;
    most = information;
    best = gamma;
  }
  constexpr double kNothing = 1.0;
  return most < kNothing ? gamma_of_blank(image) : best;
}

Exposure next_exposure(const Exposure& now, double gamma, const ExposureLimits& limits) {
  constexpr double kBrighter = 0.5;  // share of the way that the curve asks for: too bright is harder to come back from
  constexpr double kDarker = 1.0;
  constexpr double kMostFactor = 2.0;
  const double change = 1.0 - gamma;  // above zero: brighter
  const double factor = std::clamp(1.0 + (change > 0.0 ? kBrighter : kDarker) * change, 1.0 / kMostFactor, kMostFactor);
  const double light = std::max(now.light(), limits.min_seconds) * factor;
  Exposure next;
  next.seconds = std::clamp(light, limits.min_seconds, limits.max_seconds);
  next.gain = std::clamp(light / next.seconds, 1.0, std::max(1.0, limits.max_gain));
  return next;
}

}  // namespace byre
