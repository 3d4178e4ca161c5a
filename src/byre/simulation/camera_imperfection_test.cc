#include "byre/simulation/camera_imperfection.h"

#include "byre/input_error.h"

#include <cmath>
#include <functional>

#include <gtest/gtest.h>

namespace byre {
namespace {

TEST(CameraImperfection, GrowsFromExactOverGoodToWorn) {
  const CameraImperfection exact = imperfection_of(CameraCondition::exact);
  const CameraImperfection good = imperfection_of(CameraCondition::good);
  const CameraImperfection worn = imperfection_of(CameraCondition::worn);
  EXPECT_EQ(exact.calibration_level, 0.0);
  EXPECT_EQ(good.calibration_level, 1.0);
  EXPECT_EQ(worn.calibration_level, 3.0);
  EXPECT_EQ(exact.lens_blur, 0.0);
  EXPECT_LT(good.lens_blur, worn.lens_blur);
  EXPECT_LT(good.gain, worn.gain);
  for (const CameraImperfection& imperfection : {exact, good, worn}) require_valid(imperfection);
}

TEST(CameraImperfection, RejectsInvalidValues) {
  const auto refused = [](const std::function<void(CameraImperfection&)>& change) {
    CameraImperfection imperfection;
    change(imperfection);
    EXPECT_THROW(require_valid(imperfection), InputError);
  };
  refused([](CameraImperfection& camera) { camera.calibration_level = -1.0; });
  refused([](CameraImperfection& camera) { camera.rolling_shutter_s = 0.5; });
  refused([](CameraImperfection& camera) { camera.time_offset_s = std::nan(""); });
  refused([](CameraImperfection& camera) { camera.lens_blur = 50.0; });
  refused([](CameraImperfection& camera) { camera.gain = 0.0; });
  refused([](CameraImperfection& camera) { camera.offset = 300.0; });
  refused([](CameraImperfection& camera) { camera.vignetting = 1.0; });
  refused([](CameraImperfection& camera) { camera.jpeg_quality = 101; });
}

TEST(CameraImperfection, BlursTheRightImageMoreAndAtAnotherPosition) {
  CameraImperfection imperfection;
  imperfection.lens_blur = 0.8;
  const LensBlurOptions left = lens_blur_of(imperfection, StereoSide::left);
  const LensBlurOptions right = lens_blur_of(imperfection, StereoSide::right);
  EXPECT_FLOAT_EQ(left.corner_sigma, 0.8f);
  EXPECT_FLOAT_EQ(right.corner_sigma, 1.2f);
  EXPECT_GT((left.sharpest - right.sharpest).norm(), 0.05f);
}

TEST(JpegKept, DegradesWithLowerQuality) {
  Image image{64, 48, {}};
  for (int i = 0; i < 64 * 48; ++i) image.pixels.push_back(static_cast<std::uint8_t>((i * 37 + i / 64 * 91) % 200));
  const auto loss = [&](int quality) {
    const Image kept = jpeg_compressed(image, quality);
    EXPECT_EQ(kept.width, image.width);
    EXPECT_EQ(kept.pixels, jpeg_compressed(image, quality).pixels);
    double sum = 0.0;
    for (std::size_t i = 0; i < image.pixels.size(); ++i) sum += std::abs(int{kept.pixels[i]} - int{image.pixels[i]});
    return sum / static_cast<double>(image.pixels.size());
  };
  EXPECT_LT(loss(100), 1.0);
  EXPECT_GT(loss(80), 2.0 * loss(100));
  EXPECT_GT(loss(30), 1.5 * loss(80));
}

}  // namespace
}  // namespace byre
