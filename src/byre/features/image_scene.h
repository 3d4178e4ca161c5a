#pragma once

// Synthetic images for tests: unbounded textures that can be sampled between pixels, so that any shift or warp of an
// image is known exactly.

#include "byre/features.h"
#include "byre/features/detect.h"
#include "byre/image.h"

#include <array>
#include <cmath>
#include <cstdint>
#include <random>

#include <opencv2/core.hpp>

namespace byre {

// White noise blurred at several scales: a sum of lattices of random values, each smoothed by a cubic B-spline.
// Band-limited enough that linear interpolation of its pixels stays within about a grey value.
class Texture {
 public:
  explicit Texture(std::uint64_t seed, double contrast = 1.0) : seed_(seed), contrast_(contrast) {}

  // The grey value at a position in pixels; mean 128, not rounded, mostly within [0, 255].
  double operator()(double x, double y) const {
    double sum = 0.0;
    for (std::size_t i = 0; i < kLayers.size(); ++i) {
      sum += kLayers[i].strength * layer(i, x / kLayers[i].spacing, y / kLayers[i].spacing);
    }
    return 128.0 + contrast_ * sum;
  }

 private:
  struct Layer {
    double spacing;   // pixels between the lattice's points
    double strength;  // largest grey values of a lattice point
  };
  static constexpr std::array<Layer, 4> kLayers = {{{3.7, 110.0}, {6.1, 90.0}, {13.0, 60.0}, {29.0, 50.0}}};

  // In [-1, 1], deterministic.
  double lattice_value(std::size_t layer, std::int64_t column, std::int64_t row) const {
    std::uint64_t hash = seed_ * 0x9E3779B97F4A7C15u + layer;
    for (const std::int64_t coordinate : {column, row}) {  // mixing of splitmix64
      hash = (hash ^ static_cast<std::uint64_t>(coordinate)) + 0x9E3779B97F4A7C15u;
      hash = (hash ^ (hash >> 30)) * 0xBF58476D1CE4E5B9u;
      hash = (hash ^ (hash >> 27)) * 0x94D049BB133111EBu;
      hash ^= hash >> 31;
    }
    return static_cast<double>(hash >> 11) * 0x1.0p-52 - 1.0;
  }

  static std::array<double, 4> spline_weights(double t) {
    const double s = 1.0 - t;
    return {s * s * s / 6.0, (4.0 - 6.0 * t * t + 3.0 * t * t * t) / 6.0, (4.0 - 6.0 * s * s + 3.0 * s * s * s) / 6.0,
            t * t * t / 6.0};
  }

  double layer(std::size_t layer, double x, double y) const {
    const double column = std::floor(x);
    const double row = std::floor(y);
    const std::array<double, 4> along = spline_weights(x - column);
    const std::array<double, 4> down = spline_weights(y - row);
    double sum = 0.0;
    for (std::int64_t j = 0; j < 4; ++j) {
      for (std::int64_t i = 0; i < 4; ++i) {
        sum += down[static_cast<std::size_t>(j)] * along[static_cast<std::size_t>(i)] *
               lattice_value(layer, static_cast<std::int64_t>(column) + i, static_cast<std::int64_t>(row) + j);
      }
    }
    return sum;
  }

  std::uint64_t seed_;
  double contrast_;
};

inline std::uint8_t to_grey(double value) {
  return cv::saturate_cast<std::uint8_t>(value);
}

// Image of grey_at(x, y) at whole pixels.
template <typename GreyAt>
cv::Mat render(int width, int height, GreyAt grey_at) {
  cv::Mat image(height, width, CV_8U);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) image.at<std::uint8_t>(y, x) = to_grey(grey_at(double(x), double(y)));
  }
  return image;
}

// Patch of grey_at(x, y) centred at (0, 0).
template <typename GreyAt>
Patch render_patch(GreyAt grey_at) {
  constexpr int kCentre = Patch::kSize / 2;
  Patch patch;
  patch.centre = Eigen::Vector2f::Constant(kCentre);
  for (int y = 0; y < Patch::kSize; ++y) {
    for (int x = 0; x < Patch::kSize; ++x) {
      patch.pixels[static_cast<std::size_t>(y * Patch::kSize + x)] =
          to_grey(grey_at(double(x - kCentre), double(y - kCentre)));
    }
  }
  return patch;
}

inline cv::Mat white_noise(cv::Size size, std::uint32_t seed) {
  cv::Mat image(size, CV_8U);
  std::mt19937 random(seed);
  for (int y = 0; y < size.height; ++y) {
    for (int x = 0; x < size.width; ++x) image.at<std::uint8_t>(y, x) = static_cast<std::uint8_t>(random());
  }
  return image;
}

// Adds normal noise; sigma in grey values.
template <typename Pixels>
void add_noise(Pixels first, Pixels last, double sigma, std::mt19937& random) {
  std::normal_distribution<double> noise(0.0, sigma);
  for (; first != last; ++first) *first = to_grey(*first + noise(random));
}

inline void add_noise(cv::Mat& image, double sigma, std::mt19937& random) {
  add_noise(image.begin<std::uint8_t>(), image.end<std::uint8_t>(), sigma, random);
}

inline void add_noise(Patch& patch, double sigma, std::mt19937& random) {
  add_noise(patch.pixels.begin(), patch.pixels.end(), sigma, random);
}

inline Image to_image(const cv::Mat& matrix) {
  return {matrix.cols, matrix.rows,
          std::vector<std::uint8_t>(matrix.begin<std::uint8_t>(), matrix.end<std::uint8_t>())};
}

inline ScratchVector<Corner> detect_corners(const cv::Mat& level, int max_corners, const DetectOptions& options) {
  cv::Mat strengths;
  return detect_corners(level, max_corners, options, strengths);
}

}  // namespace byre
