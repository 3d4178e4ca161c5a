#pragma once

#include "byre/geometry/calibration_change.h"
#include "byre/geometry/pixel_grid.h"
#include "byre/geometry/rectification.h"

namespace byre {

// How a point's place in rectified images answers to the calibration of the cameras that took them, when the images
// are rectified by the calibration that was given. Linear: for changes by a few of the parameters' sigmas.
class CalibrationSensitivity {
 public:
  // u, v, disparity, and the right row less the left one, which is zero while the calibration is right; pixels by the
  // parameters' sigmas.
  using Jacobian = Eigen::Matrix<double, 4, kCalibrationParameters>;

  // Throws InputError when the calibration cannot be rectified.
  explicit CalibrationSensitivity(const Calibration& given);

  // Slopes for a point that is seen at this pixel. Without a disparity (not positive) the two rows of the right image
  // are zero.
  Jacobian at(const StereoPixel& pixel) const;

  const Rig& rig() const { return rig_; }

 private:
  CalibrationSensitivity(const Calibration& given, const Rectification& rectification);

  using ByCamera = Eigen::Matrix<double, 2, kParametersPerCamera>;
  using ByRightCamera = Eigen::Matrix<double, 2, kCalibrationParameters - kRightCamera>;

  Rig rig_;
  bool has_right_ = false;          // without a right camera a disparity is a depth, which owes the cameras nothing
  PixelGrid<ByCamera> left_;        // slopes of the left pixel by the left camera's parameters
  PixelGrid<ByRightCamera> right_;  // slopes of the right pixel of a point far away, by the right camera's parameters
  // Slopes of the right camera's centre by the baseline's turn, in baselines, in the rectified left camera's frame.
  Eigen::Matrix<double, 3, 2> centre_by_turn_;
};

}  // namespace byre
