#pragma once

#include "byre/calibration.h"

#include <array>
#include <cstdint>

namespace byre {

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

}  // namespace byre
