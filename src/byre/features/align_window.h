#pragma once

#include "byre/features/align.h"
#include "byre/features/align_sums.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>

namespace byre {

// View of grey values; does not own them.
struct GreyWindow {
  const std::uint8_t* pixels = nullptr;
  std::ptrdiff_t stride = 0;
  int width = 0;
  int height = 0;
};

// Fills `values` with Size x Size interpolated grey values centred at `centre`. False if they exceed the window.
template <int Size, std::size_t Count>
bool sample(const GreyWindow& window, const Eigen::Vector2f& centre, std::array<float, Count>& values) {
  static_assert(Count >= Size * Size);
  const float left = centre.x() - 0.5f * (Size - 1);
  const float top = centre.y() - 0.5f * (Size - 1);
  // Checked before the conversion to int, which is undefined out of range.
  if (!(left >= 0.0f && top >= 0.0f)) return false;
  if (!(left < static_cast<float>(window.width - Size) && top < static_cast<float>(window.height - Size))) return false;
  const int column = static_cast<int>(left);
  const int row = static_cast<int>(top);
  interpolate_square(window.pixels + row * window.stride + column, window.stride, left - static_cast<float>(column),
                     top - static_cast<float>(row), Size, values.data());
  return true;
}

// A template; centre() subtracts its mean.
template <int Size>
struct CentredTemplate {
  std::array<float, padded(Size* Size)> values{};
  float sum_of_squares = 0.0f;

  void centre() { sum_of_squares = centre_template(values.data(), Size); }
};

// Normal equations of one Gauss-Newton step, with gain and offset of the brightness eliminated.
struct AlignStep {
  Eigen::Matrix2f hessian;
  Eigen::Vector2f gradient;
  float residual_squares = 0.0f;
  float similarity = 0.0f;
};

template <int Size>
AlignStep align_step(const CentredTemplate<Size>& reference, const std::array<float, (Size + 2) * (Size + 2)>& around) {
  const AlignSums sums = align_sums(reference.values.data(), reference.sum_of_squares, around.data(), Size);
  AlignStep step;
  step.hessian << sums.xx, sums.xy, sums.xy, sums.yy;
  step.gradient << sums.x_residual, sums.y_residual;
  step.residual_squares = sums.residual_squares;
  step.similarity = sums.product / std::sqrt(reference.sum_of_squares * std::max(1e-6f, sums.squares));
  return step;
}

// Standard deviation of the position along its worse axis, with the image noise estimated from the residuals.
template <int Size>
float position_sigma(const AlignStep& step) {
  constexpr float kFreedom = Size * Size - 4;  // two parameters of position, gain, offset
  const float half_trace = 0.5f * step.hessian.trace();
  const float root = std::sqrt(std::max(0.0f, half_trace * half_trace - step.hessian.determinant()));
  return std::sqrt(step.residual_squares / kFreedom / std::max(1e-6f, half_trace - root));
}

// Gauss-Newton from start until the step is below 0.02 pixels. See align_patches.
template <int Size>
std::optional<Alignment> align_window(const CentredTemplate<Size>& reference, const GreyWindow& window,
                                      const Eigen::Vector2f& start, const AlignOptions& options) {
  constexpr float kMinSquares = 4.0f * Size * Size;  // a standard deviation of two grey values
  constexpr float kConverged = 0.02f;                // octave pixels
  if (reference.sum_of_squares < kMinSquares) return std::nullopt;
  Eigen::Vector2f pixel = start;
  std::array<float, (Size + 2) * (Size + 2)> around;
  for (int iteration = 0; iteration < options.max_iterations; ++iteration) {
    if (!sample<Size + 2>(window, pixel, around)) return std::nullopt;
    const AlignStep step = align_step<Size>(reference, around);
    const float determinant = step.hessian.determinant();
    if (!(determinant > 1e-4f * step.hessian.trace() * step.hessian.trace())) return std::nullopt;
    const Eigen::Vector2f change = -step.hessian.inverse() * step.gradient;
    pixel += change;
    if (!((pixel - start).cwiseAbs().maxCoeff() <= options.max_shift)) return std::nullopt;
    if (change.squaredNorm() < kConverged * kConverged) {
      if (step.similarity < options.min_similarity) return std::nullopt;
      return Alignment{pixel, std::max(options.min_sigma, position_sigma<Size>(step)), step.similarity};
    }
  }
  return std::nullopt;
}

}  // namespace byre
