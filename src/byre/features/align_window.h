#pragma once

#include "byre/features/align.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>

namespace byre {

// Grey values to read from; does not own them.
struct GreyWindow {
  const std::uint8_t* pixels = nullptr;
  std::ptrdiff_t stride = 0;
  int width = 0;
  int height = 0;
};

// Size x Size grey values, interpolated so that their middle lies at centre. Empty where they leave the window.
template <int Size>
std::optional<std::array<float, Size * Size>> sample(const GreyWindow& window, const Eigen::Vector2f& centre) {
  const float left = centre.x() - 0.5f * (Size - 1);
  const float top = centre.y() - 0.5f * (Size - 1);
  // Before the conversion to int, which is defined only for what fits.
  if (!(left >= 0.0f && top >= 0.0f)) return std::nullopt;
  if (!(left < static_cast<float>(window.width - Size) && top < static_cast<float>(window.height - Size))) {
    return std::nullopt;
  }
  const int column = static_cast<int>(left);
  const int row = static_cast<int>(top);
  const float fx = left - static_cast<float>(column);
  const float fy = top - static_cast<float>(row);
  const float w00 = (1.0f - fx) * (1.0f - fy), w01 = fx * (1.0f - fy), w10 = (1.0f - fx) * fy, w11 = fx * fy;
  std::array<float, Size * Size> values;
  for (int y = 0; y < Size; ++y) {
    const std::uint8_t* const upper = window.pixels + (row + y) * window.stride + column;
    const std::uint8_t* const lower = upper + window.stride;
    float* const out = values.data() + y * Size;
    for (int x = 0; x < Size; ++x) out[x] = w00 * upper[x] + w01 * upper[x + 1] + w10 * lower[x] + w11 * lower[x + 1];
  }
  return values;
}

// A template without its mean.
template <int Size>
struct CentredTemplate {
  std::array<float, Size * Size> values;
  float sum_of_squares = 0.0f;

  explicit CentredTemplate(const std::array<float, Size * Size>& grey) : values(grey) {
    float mean = 0.0f;
    for (const float value : values) mean += value;
    mean /= Size * Size;
    for (float& value : values) {
      value -= mean;
      sum_of_squares += value * value;
    }
  }
};

// The normal equations of one Gauss-Newton step, with the light's gain and offset eliminated.
struct AlignStep {
  Eigen::Matrix2f hessian;
  Eigen::Vector2f gradient;
  float residual_squares = 0.0f;
  float similarity = 0.0f;
};

template <int Size>
AlignStep align_step(const CentredTemplate<Size>& reference, const std::array<float, (Size + 2) * (Size + 2)>& around) {
  constexpr int kStride = Size + 2;
  using Values = Eigen::Array<float, Size * Size, 1>;
  Values grey, gx, gy;
  for (int y = 0; y < Size; ++y) {
    const float* const row = around.data() + (y + 1) * kStride + 1;
    for (int x = 0; x < Size; ++x) {
      const int i = y * Size + x;
      grey[i] = row[x];
      gx[i] = 0.5f * (row[x + 1] - row[x - 1]);
      gy[i] = 0.5f * (row[x + kStride] - row[x - kStride]);
    }
  }
  const Eigen::Map<const Values> expected(reference.values.data());
  grey -= grey.mean();
  gx -= gx.mean();
  gy -= gy.mean();
  const float product = (grey * expected).sum();
  const Values residual = grey - product / reference.sum_of_squares * expected;
  const float xy = (gx * gy).sum();
  AlignStep step;
  step.hessian << gx.square().sum(), xy, xy, gy.square().sum();
  step.gradient << (gx * residual).sum(), (gy * residual).sum();
  step.residual_squares = residual.square().sum();
  step.similarity = product / std::sqrt(reference.sum_of_squares * std::max(1e-6f, grey.square().sum()));
  return step;
}

// The position's standard deviation along its worse axis, from the residuals (in place of the unknown image noise).
template <int Size>
float position_sigma(const AlignStep& step) {
  constexpr float kFreedom = Size * Size - 4;  // two of position, gain, offset
  const float half_trace = 0.5f * step.hessian.trace();
  const float root = std::sqrt(std::max(0.0f, half_trace * half_trace - step.hessian.determinant()));
  return std::sqrt(step.residual_squares / kFreedom / std::max(1e-6f, half_trace - root));
}

// Gauss-Newton from start until the step is below a fiftieth of a pixel. See align_patches.
template <int Size>
std::optional<Alignment> align_window(const CentredTemplate<Size>& reference, const GreyWindow& window,
                                      const Eigen::Vector2f& start, const AlignOptions& options) {
  constexpr float kMinSquares = 4.0f * Size * Size;  // a standard deviation of two grey values
  constexpr float kSettled = 0.02f;                  // octave pixels
  if (reference.sum_of_squares < kMinSquares) return std::nullopt;
  Eigen::Vector2f pixel = start;
  for (int iteration = 0; iteration < options.max_iterations; ++iteration) {
    const auto around = sample<Size + 2>(window, pixel);
    if (!around) return std::nullopt;
    const AlignStep step = align_step<Size>(reference, *around);
    const float determinant = step.hessian.determinant();
    if (!(determinant > 1e-4f * step.hessian.trace() * step.hessian.trace())) return std::nullopt;
    const Eigen::Vector2f change = -step.hessian.inverse() * step.gradient;
    pixel += change;
    if (!((pixel - start).cwiseAbs().maxCoeff() <= options.max_shift)) return std::nullopt;
    if (change.squaredNorm() < kSettled * kSettled) {
      if (step.similarity < options.min_similarity) return std::nullopt;
      return Alignment{pixel, std::max(options.min_sigma, position_sigma<Size>(step)), step.similarity};
    }
  }
  return std::nullopt;
}

}  // namespace byre
