#include "byre/simulation/image_sensor.h"

#include <cmath>

#include <gmock/gmock.h>

namespace byre {
namespace {

using ::testing::AllOf;
using ::testing::Ge;
using ::testing::Le;

const Camera kCamera{.width = 160, .height = 120, .fx = 100.0, .fy = 100.0, .cx = 79.5, .cy = 59.5};

std::vector<float> even_light(float radiance) {
  return std::vector<float>(static_cast<std::size_t>(kCamera.width * kCamera.height), radiance);
}

double sigma_of(const Image& image) {
  const double mean = mean_grey(image);
  double sum = 0.0;
  for (const std::uint8_t grey : image.pixels) sum += (grey - mean) * (grey - mean);
  return std::sqrt(sum / static_cast<double>(image.pixels.size()));
}

TEST(ImageSensor, BrightensEquallyWithTimeAndGain) {
  const ImageSensor sensor(kCamera, {.vignetting = 0.0f, .noise = 0.0f});
  const float grey = mean_grey(sensor.expose(even_light(0.5f), {0.002f, 1.0f}, 1, 1));
  EXPECT_NEAR(mean_grey(sensor.expose(even_light(0.5f), {0.004f, 1.0f}, 1, 1)), 2.0f * grey, 1.0f);
  EXPECT_NEAR(mean_grey(sensor.expose(even_light(0.5f), {0.002f, 2.0f}, 1, 1)), 2.0f * grey, 1.0f);
}

TEST(ImageSensor, IsNoisierWithMoreGain) {
  const ImageSensor sensor(kCamera, {.vignetting = 0.0f});
  const Image bright = sensor.expose(even_light(1.0f), {0.002f, 1.0f}, 1, 1);
  const Image amplified = sensor.expose(even_light(0.25f), {0.002f, 4.0f}, 1, 1);
  EXPECT_NEAR(mean_grey(bright), mean_grey(amplified), 1.0f);
  EXPECT_GT(sigma_of(bright), 0.8);
  EXPECT_NEAR(sigma_of(amplified) / sigma_of(bright), 2.1, 0.3);
}

TEST(ImageSensor, DarkensTowardsTheCorners) {
  const ImageSensor sensor(kCamera, {.vignetting = 0.4f, .noise = 0.0f});
  const Image image = sensor.expose(even_light(1.0f), {0.003f, 1.0f}, 1, 1);
  const double centre = image.pixels[60 * 160 + 80];
  EXPECT_NEAR(image.pixels.front() / centre, 0.6, 0.03);
}

TEST(ImageSensor, LosesContrastBehindDirt) {
  const ImageSensor clean(kCamera, {.vignetting = 0.0f, .noise = 0.0f});
  const ImageSensor dirty(kCamera, {.vignetting = 0.0f, .dirt = 4.0f, .noise = 0.0f});
  std::vector<float> stripes = even_light(0.2f);
  for (std::size_t i = 0; i < stripes.size(); i += 2) stripes[i] = 1.0f;
  const Exposure exposure{0.004f, 1.0f};
  EXPECT_LT(sigma_of(dirty.expose(stripes, exposure, 1, 1)), 0.97 * sigma_of(clean.expose(stripes, exposure, 1, 1)));
}

TEST(ImageSensor, AppliesItsOwnGainAndOffset) {
  const ImageSensor usual(kCamera, {.vignetting = 0.0f, .noise = 0.0f});
  const ImageSensor bright(kCamera, {.vignetting = 0.0f, .noise = 0.0f, .gain = 1.1f, .offset = 5.0f});
  const float grey = mean_grey(usual.expose(even_light(0.5f), {}, 1, 1));
  EXPECT_NEAR(mean_grey(bright.expose(even_light(0.5f), {}, 1, 1)), 1.1f * grey + 5.0f, 1.0f);
  EXPECT_NEAR(mean_grey(bright.expose(even_light(0.0f), {}, 1, 1)), 5.0f, 0.01f);
}

TEST(ImageSensor, IsBlurredInTheCornersByTheLens) {
  const ImageSensor sensor(kCamera, {.vignetting = 0.0f, .noise = 0.0f, .blur = {1.0f}});
  std::vector<float> stripes = even_light(0.2f);
  for (std::size_t i = 0; i < stripes.size(); i += 2) stripes[i] = 0.8f;
  const Image image = sensor.expose(stripes, {}, 1, 1);
  const auto contrast = [&](std::size_t column, std::size_t row) {
    return std::abs(int{image.pixels[row * 160 + column]} - int{image.pixels[row * 160 + column + 1]});
  };
  EXPECT_GT(contrast(80, 60), 100);
  EXPECT_LT(contrast(2, 2), 20);
}

TEST(ImageSensor, IsIndependentOfTheNumberOfThreads) {
  const ImageSensor sensor(kCamera, {});
  const std::vector<float> light = even_light(0.7f);
  EXPECT_EQ(sensor.expose(light, {}, 5, 1).pixels, sensor.expose(light, {}, 5, 4).pixels);
  EXPECT_NE(sensor.expose(light, {}, 5, 1).pixels, sensor.expose(light, {}, 6, 1).pixels);
}

TEST(Exposure, SettlesAtTheTargetBrightness) {
  const ImageSensor sensor(kCamera, {.vignetting = 0.0f});
  const ExposureLimits limits;
  for (const float radiance : {0.05f, 0.4f, 5.0f}) {
    Exposure exposure;
    for (int i = 0; i < 20; ++i) {
      exposure = next_exposure(exposure, mean_grey(sensor.expose(even_light(radiance), exposure, 1, 1)), limits);
    }
    EXPECT_NEAR(mean_grey(sensor.expose(even_light(radiance), exposure, 1, 1)), limits.target_grey, 4.0f);
  }
}

TEST(Exposure, IncreasesTimeBeforeGainWithinItsLimits) {
  const ExposureLimits limits;
  Exposure exposure{0.004f, 1.0f};
  exposure = next_exposure(exposure, 0.5f * limits.target_grey, limits);
  EXPECT_GT(exposure.time_s, 0.004f);
  EXPECT_EQ(exposure.gain, 1.0f);
  for (int i = 0; i < 20; ++i) exposure = next_exposure(exposure, 1.0f, limits);
  EXPECT_EQ(exposure.time_s, limits.max_time_s);
  EXPECT_EQ(exposure.gain, limits.max_gain);
  for (int i = 0; i < 40; ++i) exposure = next_exposure(exposure, 250.0f, limits);
  EXPECT_THAT(exposure.time_s, AllOf(Ge(limits.min_time_s), Le(1.1f * limits.min_time_s)));
}

}  // namespace
}  // namespace byre
