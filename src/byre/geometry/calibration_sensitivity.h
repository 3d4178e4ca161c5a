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

  // Of a point that is seen at this pixel. Without a disparity (not positive) the two rows of the right image are zero.
  Jacobian at(const StereoPixel& pixel) const;

  const Rig& rig() const { return rig_; }

 private:
  CalibrationSensitivity(const Calibration& given, const Rectification& rectification);

  using ByCamera = Eigen::Matrix<double, 2, kParametersPerCamera>;
  using ByRightCamera = Eigen::Matrix<double, 2, kCalibrationParameters - kRightCamera>;

  Rig rig_;
  bool has_right_ = false;  // else a disparity is a depth, which owes the cameras nothing
  PixelGrid<ByCamera> left_;
  PixelGrid<ByRightCamera> right_;              // of points far away
  Eigen::Matrix<double, 3, 2> centre_by_turn_;  // of the right camera, in baselines, as the rectified left one sees it
};

}  // namespace byre
