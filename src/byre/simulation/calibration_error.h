#pragma once

#include "byre/calibration.h"

#include <array>
#include <cstdint>

namespace byre {

// By how much the calibration of one camera is off.
struct CameraError {
  double focal = 0.0;                                // share of both focal lengths
  Eigen::Vector2d centre = Eigen::Vector2d::Zero();  // principal point, pixels
  std::array<double, 4> distortion{};                // first coefficients of the lens model
};

// By how much the calibration of a pair is off.
struct CalibrationError {
  CameraError left;
  CameraError right;
  Eigen::Vector3d right_turned = Eigen::Vector3d::Zero();  // radians about the right camera's axes
  Eigen::Vector3d right_moved = Eigen::Vector3d::Zero();   // metres along the right camera's axes
};

// What calibrations in the field are off by, drawn from normal distributions. Their standard deviations at level 1, a
// good calibration (0.1 to 0.2 pixels of reprojection error): focal lengths 0.04 %, principal point 0.15 pixels in u
// and v, first and second coefficient of the lens 0.001, third and fourth 0.0001, the right camera turned by 0.01
// degrees about each axis and moved by 0.1 mm along each. All grow in proportion to the level: 0 is exact, 3 worn. The
// same seed is the same error at every level, so that one robot errs alike in all its recordings.
CalibrationError draw_calibration_error(double level, std::uint64_t seed);

// A calibration that is off by the error. A pinhole camera gets a radial-tangential lens, where the error has one.
Calibration perturbed(const Calibration& calibration, const CalibrationError& error);

// A calibration that is off by the error that level and seed draw.
Calibration perturbed(const Calibration& calibration, double level, std::uint64_t seed);

}  // namespace byre
