#pragma once

#include "byre/calibration.h"

#include <array>
#include <string_view>

namespace byre {

// Parameters of a calibration that may be in error. Per camera: focal length, aspect ratio, principal point, distortion
// coefficients 1 to 4. Also rotation and direction of the right camera, but not the baseline's length, which images
// cannot measure.
inline constexpr int kParametersPerCamera = 8;
// Order of a camera's parameters.
inline constexpr int kFocal = 0, kAspect = 1, kCentreU = 2, kCentreV = 3, kFirstDistortion = 4;
inline constexpr int kLeftCamera = 0;                            // index of the left camera's first parameter
inline constexpr int kRightCamera = kParametersPerCamera;        // index of the right camera's first parameter
inline constexpr int kRightRotation = 2 * kParametersPerCamera;  // three: rotation about x, y, z of the right camera
inline constexpr int kBaselineTurn = kRightRotation + 3;         // two: direction of the baseline, about z and y
inline constexpr int kCalibrationParameters = kBaselineTurn + 2;

using CalibrationVector = Eigen::Matrix<double, kCalibrationParameters, 1>;
using CalibrationMatrix = Eigen::Matrix<double, kCalibrationParameters, kCalibrationParameters>;

struct CalibrationParameter {
  std::string_view name;
  std::string_view unit;
  double sigma;  // standard error of a good calibration, in the parameter's unit
};

const std::array<CalibrationParameter, kCalibrationParameters>& calibration_parameters();

// Whether these are nominal numbers, as drivers publish for cameras that were never calibrated: one camera without
// distortion, with equal focal lengths, and the principal point at a whole or half pixel.
bool is_nominal(const Calibration& calibration);

// False for parameters of the right camera in a monocular calibration.
bool has_parameter(const Calibration& calibration, int parameter);

// The calibration with each parameter changed by a number of its sigmas. The right camera's centre moves about the left
// one's at constant distance. A pinhole camera that gets a distortion becomes radial_tangential.
Calibration changed(const Calibration& calibration, const CalibrationVector& sigmas);

// Result of self-calibration: the given calibration refined by the images of a run.
struct RefinedCalibration {
  Calibration calibration;
  CalibrationVector change = CalibrationVector::Zero();  // refined less given parameters, in the parameters' sigmas
  CalibrationVector sigma_before = CalibrationVector::Zero();  // standard errors as given, in the parameters' sigmas
  CalibrationVector sigma_after = CalibrationVector::Zero();   // standard errors as refined, in the parameters' sigmas
  int keyframes = 0;                                           // keyframes used
  int observations = 0;                                        // observations of points by these keyframes
  // Root-mean-square image motion (u, v, disparity) by the change, without the mean of u and v, which acts like a
  // rotation; pixels. Without a change: that of the refused change, too large for an error of a calibration.
  double shift = 0.0;

  bool was_refused() const { return shift > 0.0 && change.isZero(0.0); }
  // Whether the refused change exceeds any plausible error of these cameras' calibration. For calibrations of real
  // recordings refused changes are 0.6 to 2.4 pixels.
  bool is_implausible() const { return was_refused() && shift >= 3.0; }
};

}  // namespace byre
