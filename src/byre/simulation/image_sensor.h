#pragma once

#include "byre/calibration.h"
#include "byre/image.h"
#include "byre/simulation/camera_imperfection.h"

#include <cstdint>
#include <vector>

namespace byre {

struct Exposure {
  float time_s = 0.003f;
  float gain = 1.0f;
};

struct ExposureLimits {
  float min_time_s = 0.0002f;
  float max_time_s = 0.010f;
  float max_gain = 8.0f;
  float target_grey = 105.0f;  // target mean of the image
};

// Automatic exposure: the setting for the next frame from this frame's mean grey value. Corrects half of the error, by
// time before gain.
Exposure next_exposure(const Exposure& exposure, float mean_grey, const ExposureLimits& limits);

float mean_grey(const Image& image);

struct ImageSensorOptions {
  float vignetting = 0.35f;  // share of the light lost in the corners
  float dirt = 0.0f;         // dirt on the lens: 0 none, 1 a dozen soft spots
  float noise = 1.0f;        // relative to a usual sensor
  float gain = 1.0f;         // multiplies the exposure's gain
  float offset = 0.0f;       // grey value without light
  LensBlurOptions blur{};
  std::uint64_t seed = 1;
};

class ImageSensor {
 public:
  ImageSensor(const Camera& camera, const ImageSensorOptions& options);

  // radiance: one value per pixel, row-major. Deterministic for any number of threads.
  Image expose(const std::vector<float>& radiance, const Exposure& exposure, std::uint64_t noise_seed,
               int threads) const;

 private:
  Image read_out(const std::vector<float>& radiance, const Exposure& exposure, std::uint64_t noise_seed,
                 int threads) const;
  void add_spot(float x, float y, float radius, float strength, std::uint64_t seed);

  int width_;
  int height_;
  float noise_;
  float gain_;
  float offset_;
  LensBlur blur_;
  std::vector<float> transmission_;  // share of the light that each pixel receives
  std::vector<float> veil_;          // share of the image's mean light that dirt scatters into each pixel
};

}  // namespace byre
