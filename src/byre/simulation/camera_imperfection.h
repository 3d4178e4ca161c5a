#pragma once

#include "byre/image.h"
#include "byre/simulation/lens_blur.h"

#include <cstdint>
#include <optional>
#include <string_view>

namespace byre {

// How a stereo camera differs from the ideal pair of which its calibration speaks.
struct CameraImperfection {
  double calibration_level = 0.0;  // see draw_calibration_error; 0: the calibration is exact
  std::uint64_t calibration_seed = 1;
  double rolling_shutter_s = 0.0;  // time to read all rows, one after the other; 0: all are exposed at once
  double time_offset_s = 0.0;      // seconds by which the right camera is exposed later
  double lens_blur = 0.0;          // sigma in the corners of the left image, pixels; see lens_blur_of
  double gain = 1.0;               // right camera's, where the left one has 1
  double offset = 0.0;             // right camera's, grey values, where the left one has 0
  double vignetting = 0.35;        // share of the light that is lost in the corners
  int jpeg_quality = 0;            // 1 to 100, of the images as they are kept; 0: without loss
};

// A camera that is what its calibration says; a good one, calibrated with care; one that has been in use for years.
enum class CameraCondition : std::uint8_t { exact, good, worn };

std::string_view to_string(CameraCondition condition);
std::optional<CameraCondition> camera_condition_of(std::string_view name);  // empty when it names none

// What comes with age and use, the same whatever the seed of the calibration. How a camera is built (its shutter, its
// trigger) is left at what is best.
CameraImperfection imperfection_of(CameraCondition condition);

// Throws InputError when a number makes no sense.
void require_sensible(const CameraImperfection& imperfection);

// No two lenses are alike: the right one blurs half as much again, and is sharpest elsewhere.
enum class StereoSide : std::uint8_t { left, right };
LensBlurOptions lens_blur_of(const CameraImperfection& imperfection, StereoSide side);

// As it is after it was kept as JPEG of this quality, 1 to 100.
Image jpeg_kept(const Image& image, int quality);

}  // namespace byre
