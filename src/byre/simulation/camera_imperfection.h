#pragma once

#include "byre/calibration.h"
#include "byre/image.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>
#include <vector>

#include <Eigen/Core>

namespace byre {

struct LensBlurOptions {
  float corner_sigma = 0.0f;  // pixels, at the distance from the sharpest point that a corner has from the centre
  Eigen::Vector2f sharpest{0.0f, 0.0f};  // offset from the image centre, in image widths
};

// Lens blur from field curvature: approximately Gaussian, with a sigma that grows with the square of the distance from
// the sharpest point.
class LensBlur {
 public:
  LensBlur(int width, int height, const LensBlurOptions& options);

  bool is_sharp() const { return steps_ == 0; }  // everywhere
  float sigma_at(int column, int row) const;     // pixels

  // image: one value per pixel, row-major. Deterministic for any number of threads (0: one per core).
  std::vector<float> blurred(const std::vector<float>& image, int threads) const;

 private:
  std::size_t index(int column, int row) const;
  std::vector<float> step_further(const std::vector<float>& image, int threads) const;

  int width_;
  int height_;
  int steps_ = 0;                 // number of equal variance steps up to the largest blur
  float step_variance_ = 0.0f;    // pixels squared
  std::vector<float> variances_;  // variance of each pixel, in steps; empty when is_sharp()
};

struct CameraError {
  double focal = 0.0;                                // relative error of both focal lengths
  Eigen::Vector2d centre = Eigen::Vector2d::Zero();  // principal point, pixels
  std::array<double, 4> distortion{};                // first coefficients of the lens model
};

struct CalibrationError {
  CameraError left;
  CameraError right;
  Eigen::Vector3d right_rotation = Eigen::Vector3d::Zero();     // radians about the right camera's axes
  Eigen::Vector3d right_translation = Eigen::Vector3d::Zero();  // metres along the right camera's axes
};

// Draws a typical calibration error from normal distributions. Standard deviations at level 1, a good calibration (0.1
// to 0.2 pixels of reprojection error): focal lengths 0.04 %, principal point 0.15 pixels in u and v, first and second
// lens coefficients 0.001, third and fourth 0.0001, rotation of the right camera 0.01 degrees about each axis,
// translation 0.1 mm along each. All are proportional to the level: 0 is exact, 3 is worn. The same seed gives the same
// error, scaled by the level, in all recordings of one robot.
CalibrationError draw_calibration_error(double level, std::uint64_t seed);

// Adds the error to a calibration. A pinhole camera becomes radial-tangential if the error has distortion.
Calibration perturbed(const Calibration& calibration, const CalibrationError& error);

// Adds the error of draw_calibration_error(level, seed).
Calibration perturbed(const Calibration& calibration, double level, std::uint64_t seed);

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
