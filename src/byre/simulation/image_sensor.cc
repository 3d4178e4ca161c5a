#include "byre/simulation/image_sensor.h"

#include "byre/simulation/row_workers.h"
#include "byre/simulation/seeded_draws.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace byre {
namespace {

constexpr float kGreyPerLight = 60000.0f;    // grey values per unit of radiance and second
constexpr float kShotVariance = 0.026f;      // grey values squared per grey value, at a gain of 1
constexpr float kReadSigma = 0.6f;           // grey values, at a gain of 1
constexpr float kBrightestCounted = 300.0f;  // grey values: clamps windows in the scattered light

// Approximately normal with sigma 1: the sum of four uniform 16-bit numbers.
float normal_from(std::uint64_t bits) {
  constexpr float kSigma = 65536.0f * 0.5773503f;
  const std::uint64_t sum = (bits & 0xffff) + ((bits >> 16) & 0xffff) + ((bits >> 32) & 0xffff) + (bits >> 48);
  return (static_cast<float>(sum) - 2.0f * 65535.0f) / kSigma;
}

}  // namespace

Exposure next_exposure(const Exposure& exposure, float mean, const ExposureLimits& limits) {
  const float factor = std::sqrt(std::clamp(limits.target_grey / std::max(mean, 1.0f), 0.25f, 4.0f));
  const float wanted = exposure.time_s * exposure.gain * factor;
  const float time_s = std::clamp(wanted, limits.min_time_s, limits.max_time_s);
  return {time_s, std::clamp(wanted / time_s, 1.0f, limits.max_gain)};
}

float mean_grey(const Image& image) {
  const auto sum = std::accumulate(image.pixels.begin(), image.pixels.end(), std::uint64_t{0});
  return static_cast<float>(sum) / static_cast<float>(std::max<std::size_t>(image.pixels.size(), 1));
}

ImageSensor::ImageSensor(const Camera& camera, const ImageSensorOptions& options)
    : width_(camera.width),
      height_(camera.height),
      noise_(options.noise),
      gain_(options.gain),
      offset_(options.offset),
      blur_(camera.width, camera.height, options.blur) {
  const auto half_width = 0.5f * static_cast<float>(width_);
  const auto half_height = 0.5f * static_cast<float>(height_);
  const float corner = half_width * half_width + half_height * half_height;
  for (int row = 0; row < height_; ++row) {
    for (int column = 0; column < width_; ++column) {
      const float x = static_cast<float>(column) - static_cast<float>(camera.cx);
      const float y = static_cast<float>(row) - static_cast<float>(camera.cy);
      transmission_.push_back(1.0f - options.vignetting * (x * x + y * y) / corner);
    }
  }
  veil_.resize(transmission_.size(), 0.0f);
  SeededDraws draws(options.seed, 1);
  const float scale = static_cast<float>(width_) / 752.0f;
  for (int i = 0; i < static_cast<int>(std::lround(12.0f * options.dirt)); ++i) {
    const float x = draws.between(0.0f, static_cast<float>(width_));
    const float y = draws.between(0.0f, static_cast<float>(height_));
    add_spot(x, y, scale * draws.between(12.0f, 55.0f), draws.between(0.15f, 0.6f), draws.bits());
  }
}

// A dirt spot out of focus, fading towards its uneven border.
void ImageSensor::add_spot(float x, float y, float radius, float strength, std::uint64_t seed) {
  SeededDraws draws(seed, 2);
  const float lobes = std::floor(draws.between(2.0f, 6.0f));
  const float phase = draws.between(0.0f, 6.0f);
  for (int row = 0; row < height_; ++row) {
    for (int column = 0; column < width_; ++column) {
      const float dx = static_cast<float>(column) - x;
      const float dy = static_cast<float>(row) - y;
      const float rim = radius * (1.0f + 0.2f * std::sin(lobes * std::atan2(dy, dx) + phase));
      const float covered = strength * std::clamp(1.6f * (1.0f - std::hypot(dx, dy) / rim), 0.0f, 1.0f);
      const auto i = static_cast<std::size_t>(row * width_ + column);
      transmission_[i] *= 1.0f - covered;
      veil_[i] += 0.4f * covered;
    }
  }
}

Image ImageSensor::expose(const std::vector<float>& radiance, const Exposure& exposure, std::uint64_t noise_seed,
                          int threads) const {
  if (!blur_.is_sharp()) return read_out(blur_.blurred(radiance, threads), exposure, noise_seed, threads);
  return read_out(radiance, exposure, noise_seed, threads);
}

Image ImageSensor::read_out(const std::vector<float>& radiance, const Exposure& exposure, std::uint64_t noise_seed,
                            int threads) const {
  const float gain = exposure.gain * gain_;
  const float scale = kGreyPerLight * exposure.time_s * gain;
  double sum = 0.0;
  for (const float light : radiance) sum += std::min(scale * light, kBrightestCounted);
  const auto scattered = static_cast<float>(sum / static_cast<double>(radiance.size()));
  const float read_sigma = kReadSigma * gain;
  Image image{width_, height_, std::vector<std::uint8_t>(radiance.size())};
  for_each_row(height_, threads, [&](int row) {
    for (int column = 0; column < width_; ++column) {
      const auto i = static_cast<std::size_t>(row * width_ + column);
      const float grey = scale * radiance[i] * transmission_[i] + scattered * veil_[i];
      const float sigma = std::sqrt(read_sigma * read_sigma + kShotVariance * gain * grey);
      const float noise = noise_ * sigma * normal_from(hash(noise_seed, i, 0));
      image.pixels[i] = static_cast<std::uint8_t>(std::clamp(grey + noise + offset_ + 0.5f, 0.0f, 255.0f));
    }
  });
  return image;
}

}  // namespace byre
