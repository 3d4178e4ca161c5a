#include "byre/camera/exposure.h"

#include "byre/simulation/image_sensor.h"

#include <algorithm>
#include <cmath>
#include <functional>

#include <gmock/gmock.h>

namespace byre {
namespace {

constexpr int kWidth = 320;
constexpr int kHeight = 240;

// Light from a point of a scene; 1 saturates a pixel in 1 ms.
using Scene = std::function<double(int x, int y)>;

bool is_dark_square(int x, int y) {
  return (x / 10 + y / 10) % 2 == 0;
}

Scene squares(double light) {
  return [=](int x, int y) { return light * (is_dark_square(x, y) ? 0.4 : 1.0); };
}

// Image of a camera whose pixels saturate.
Image taken(const Scene& scene, const CameraExposure& exposure) {
  Image image{kWidth, kHeight, {}};
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      const double filled = std::min(1.0, scene(x, y) * exposure.light() / 1e-3);
      image.pixels.push_back(static_cast<std::uint8_t>(std::lround(255.0 * filled)));
    }
  }
  return image;
}

CameraExposure settled(const Scene& scene, CameraExposure exposure, const CameraExposureLimits& limits) {
  for (int i = 0; i < 60; ++i) exposure = next_exposure(exposure, best_exposure_factor(taken(scene, exposure)), limits);
  return exposure;
}

TEST(Exposure, IncreasesIfTooDarkAndDecreasesIfTooBright) {
  const CameraExposureLimits limits{.max_seconds = 0.02};
  const CameraExposure now{2e-3, 1.0};
  EXPECT_GT(next_exposure(now, 1.7, limits).light(), 1.1 * now.light());
  EXPECT_LT(next_exposure(now, 0.6, limits).light(), 0.9 * now.light());
  EXPECT_DOUBLE_EQ(next_exposure(now, 1.0, limits).light(), now.light());
}

TEST(Exposure, NeverExceedsItsLimits) {
  const CameraExposureLimits limits{.min_seconds = 1e-4, .max_seconds = 5e-3, .max_gain = 4.0};
  CameraExposure exposure{1e-3, 1.0};
  for (int i = 0; i < 100; ++i) {
    exposure = next_exposure(exposure, 3.0, limits);
    EXPECT_LE(exposure.seconds, limits.max_seconds);
    EXPECT_LE(exposure.gain, limits.max_gain);
  }
  EXPECT_DOUBLE_EQ(exposure.seconds, limits.max_seconds);
  EXPECT_DOUBLE_EQ(exposure.gain, limits.max_gain);
  for (int i = 0; i < 100; ++i) exposure = next_exposure(exposure, 0.3, limits);
  EXPECT_DOUBLE_EQ(exposure.seconds, limits.min_seconds);
  EXPECT_DOUBLE_EQ(exposure.gain, 1.0);
}

TEST(Exposure, UsesTimeBeforeGain) {
  const CameraExposureLimits limits{.max_seconds = 5e-3, .max_gain = 8.0};
  EXPECT_DOUBLE_EQ(next_exposure({2e-3, 1.0}, 1.7, limits).gain, 1.0);
  EXPECT_GT(next_exposure({5e-3, 1.0}, 1.7, limits).gain, 1.2);
  const CameraExposure darker = next_exposure({5e-3, 4.0}, 0.6, limits);
  EXPECT_DOUBLE_EQ(darker.seconds, 5e-3) << "gain is reduced first, as it adds noise";
  EXPECT_LT(darker.gain, 3.0);
}

TEST(Exposure, FindsCornersFromTooDarkAndFromTooBright) {
  const CameraExposureLimits limits{.max_seconds = 0.05};
  for (const double light : {0.1, 1.0, 8.0}) {
    const Scene scene = squares(light);
    for (const double start : {2e-4, 4e-2}) {
      const CameraExposure exposure = settled(scene, {start, 1.0}, limits);
      const double mean = mean_grey(taken(scene, exposure));
      EXPECT_GT(mean, 60.0) << light << " from " << start;
      EXPECT_LT(mean, 230.0) << light << " from " << start;
      EXPECT_GE(corner_information(taken(scene, exposure), 1.0), corner_information(taken(scene, {start, 1.0}), 1.0));
    }
  }
}

// A featureless window covers half of the image, so the mean does not represent the wall next to it.
TEST(Exposure, DependsOnCornersNotOnTheMean) {
  const Scene scene = [](int x, int y) { return x < kWidth / 2 ? 5.0 : 0.15 * squares(1.0)(x, y); };
  const CameraExposure exposure = settled(scene, {2e-4, 1.0}, {.max_seconds = 0.05});
  const Image image = taken(scene, exposure);
  const Image by_mean = taken(scene, {0.19e-3, 1.0});  // mean of 128
  EXPECT_NEAR(mean_grey(by_mean), 128.0, 10.0);
  EXPECT_GT(mean_grey(image), 150.0) << "the window may be white";
  EXPECT_GT(corner_information(image, 1.0), 2.0 * corner_information(by_mean, 1.0));
}

TEST(Exposure, Converges) {
  const CameraExposureLimits limits{.max_seconds = 0.05};
  const Scene scene = squares(1.0);
  const CameraExposure settling = settled(scene, {2e-4, 1.0}, limits);
  for (CameraExposure exposure = settling; const int step : {1, 2, 3}) {
    exposure = next_exposure(exposure, best_exposure_factor(taken(scene, exposure)), limits);
    EXPECT_NEAR(exposure.light() / settling.light(), 1.0, 0.1) << step;
  }
}

TEST(Exposure, StaysConstantWithoutTexture) {
  const CameraExposure exposure = settled([](int, int) { return 0.5; }, {1e-3, 1.0}, {});
  EXPECT_DOUBLE_EQ(exposure.light(), 1e-3);
}

}  // namespace
}  // namespace byre
