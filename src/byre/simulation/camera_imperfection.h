#pragma once

#include "byre/image.h"
#include "byre/simulation/lens_blur.h"

#include <cstdint>
#include <string_view>

namespace byre {

// Deviations of a simulated stereo camera from an ideal, exactly calibrated pair.
struct CameraImperfection {
  double calibration_level = 0.0;  // see draw_calibration_error; 0: exact calibration
  std::uint64_t calibration_seed = 1;
  double rolling_shutter_s = 0.0;  // readout time from the first row to the last; 0: global shutter
  double time_offset_s = 0.0;      // exposure delay of the right camera, seconds
  double lens_blur = 0.0;          // sigma in the corners of the left image, pixels; see lens_blur_of
  double gain = 1.0;
  double offset = 0.0;       // grey values that the right camera adds
  double vignetting = 0.35;  // share of the light lost in the corners
  int jpeg_quality = 0;      // 1 to 100; 0: lossless
};

// exact: matches its calibration; good: calibrated with care; worn: years of use.
enum class CameraCondition : std::uint8_t { exact, good, worn };

std::string_view to_string(CameraCondition condition);

// Imperfections of a condition, with the default calibration seed. Shutter and trigger stay ideal.
CameraImperfection imperfection_of(CameraCondition condition);

// Throws InputError for values out of range.
void require_valid(const CameraImperfection& imperfection);

// The right lens blurs 1.5 times as much as the left one and is sharpest elsewhere.
enum class StereoSide : std::uint8_t { left, right };
LensBlurOptions lens_blur_of(const CameraImperfection& imperfection, StereoSide side);

// JPEG round trip of an image; quality 1 to 100.
Image jpeg_compressed(const Image& image, int quality);

}  // namespace byre
