#include "byre/simulation/lens_blur.h"

#include "byre/simulation/row_workers.h"

#include <algorithm>
#include <cmath>

namespace byre {
namespace {

// Largest variance of one pass over neighbours: weights 1/4, 1/2, 1/4.
constexpr float kMaxVariancePerStep = 0.5f;

}  // namespace

LensBlur::LensBlur(int width, int height, const LensBlurOptions& options) : width_(width), height_(height) {
  if (options.corner_sigma <= 0.0f) return;
  const auto half_width = 0.5f * static_cast<float>(width);
  const auto half_height = 0.5f * static_cast<float>(height);
  const float corner = half_width * half_width + half_height * half_height;
  variances_.reserve(static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
  for (int row = 0; row < height; ++row) {
    for (int column = 0; column < width; ++column) {
      const float x = static_cast<float>(column) + 0.5f - half_width * (1.0f + 2.0f * options.sharpest.x());
      const float y = static_cast<float>(row) + 0.5f - half_height - static_cast<float>(width) * options.sharpest.y();
      const float sigma = options.corner_sigma * (x * x + y * y) / corner;
      variances_.push_back(sigma * sigma);
    }
  }
  const float largest = *std::ranges::max_element(variances_);
  steps_ = static_cast<int>(std::ceil(largest / kMaxVariancePerStep));
  step_variance_ = largest / static_cast<float>(steps_);
  for (float& variance : variances_) variance /= step_variance_;
}

std::size_t LensBlur::index(int column, int row) const {
  return static_cast<std::size_t>(row) * static_cast<std::size_t>(width_) + static_cast<std::size_t>(column);
}

float LensBlur::sigma_at(int column, int row) const {
  return is_sharp() ? 0.0f : std::sqrt(step_variance_ * variances_[index(column, row)]);
}

// One pass down the columns and along the rows; adds the variance of one step everywhere.
std::vector<float> LensBlur::step_further(const std::vector<float>& image, int threads) const {
  const float aside = 0.5f * step_variance_;
  const float middle = 1.0f - step_variance_;
  std::vector<float> result(image.size());
  for_each_row(height_, threads, [&](int row) {
    const float* const here = &image[index(0, row)];
    const float* const above = &image[index(0, std::max(row - 1, 0))];
    const float* const below = &image[index(0, std::min(row + 1, height_ - 1))];
    std::vector<float> padded(static_cast<std::size_t>(width_) + 2);
    for (std::size_t i = 0; i < static_cast<std::size_t>(width_); ++i) {
      padded[i + 1] = middle * here[i] + aside * (above[i] + below[i]);
    }
    padded.front() = padded[1];
    padded.back() = padded[static_cast<std::size_t>(width_)];
    float* const out = &result[index(0, row)];
    for (std::size_t i = 0; i < static_cast<std::size_t>(width_); ++i) {
      out[i] = middle * padded[i + 1] + aside * (padded[i] + padded[i + 2]);
    }
  });
  return result;
}

// Interpolates between passes: the variance of a mixture of two normal distributions is the mixture of theirs.
std::vector<float> LensBlur::blurred(const std::vector<float>& image, int threads) const {
  std::vector<float> result = image;
  std::vector<float> here = image;
  for (int step = 0; step < steps_; ++step) {
    std::vector<float> further = step_further(here, threads);
    const auto steps_done = static_cast<float>(step);
    for (std::size_t i = 0; i < result.size(); ++i) {
      const float share = variances_[i] - steps_done;
      if (share > 0.0f) result[i] = here[i] + std::min(share, 1.0f) * (further[i] - here[i]);
    }
    here = std::move(further);
  }
  return result;
}

}  // namespace byre
