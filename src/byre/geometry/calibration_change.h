#pragma once

#include "byre/calibration.h"

#include <array>
#include <string_view>

namespace byre {

// What may be wrong with a calibration. Of each camera: focal length, its aspect, principal point, distortion
// coefficients 1 to 4; and where the right camera looks and lies. The length of the baseline is not among them: images
// alone never tell it.
inline constexpr int kParametersPerCamera = 8;
inline constexpr int kLeftCamera = 0;                            // index of the left camera's first parameter
inline constexpr int kRightCamera = kParametersPerCamera;        // index of the right camera's first parameter
inline constexpr int kRightRotation = 2 * kParametersPerCamera;  // three: about x, y, z of the right camera
inline constexpr int kBaselineTurn = kRightRotation + 3;         // two: about z and y, as the left camera sees it
inline constexpr int kCalibrationParameters = kBaselineTurn + 2;

using CalibrationVector = Eigen::Matrix<double, kCalibrationParameters, 1>;
using CalibrationMatrix = Eigen::Matrix<double, kCalibrationParameters, kCalibrationParameters>;

struct CalibrationParameter {
  std::string_view name;
  std::string_view unit;
  double sigma;  // standard error of a good calibration, in the parameter's unit
};

const std::array<CalibrationParameter, kCalibrationParameters>& calibration_parameters();

// Whether the parameter means anything to these cameras: not the right one's to a single camera.
bool has_parameter(const Calibration& calibration, int parameter);

// The calibration with each parameter changed by so many of its sigmas. The camera centres move about the left one's at
// the same distance; a pinhole camera that gets a distortion becomes radial_tangential.
Calibration changed(const Calibration& calibration, const CalibrationVector& sigmas);

// What the images of a run have told of the calibration that was given for them.
struct RefinedCalibration {
  Calibration calibration;
  CalibrationVector change = CalibrationVector::Zero();  // refined less given parameters, in the parameters' sigmas
  CalibrationVector sigma_before = CalibrationVector::Zero();  // standard errors as given, in the parameters' sigmas
  CalibrationVector sigma_after = CalibrationVector::Zero();   // standard errors as refined, in the parameters' sigmas
  int keyframes = 0;                                           // keyframes that were looked at
  int observations = 0;                                        // observations of points by these keyframes
  // Pixels, root mean square by which the change moves what is seen, disparity too, turns apart. Where there is no
  // change, of the one that was refused, as too large for an error of a calibration.
  double shift = 0.0;

  bool was_refused() const { return shift > 0.0 && change.isZero(0.0); }
  // Whether the refused change is beyond any error of a calibration of these cameras. For calibrations of real
  // recordings refused changes are 0.6 to 2.4 pixels.
  bool is_implausible() const { return was_refused() && shift >= 3.0; }
};

}  // namespace byre
