#pragma once

#include "byre/geometry/calibration_change.h"
#include "byre/geometry/pixel_grid.h"
#include "byre/geometry/rectification.h"

namespace byre {

// Derivatives of a point's rectified measurement by the true calibration of the cameras, while the images are rectified
// by the given one. Linear: valid for changes by a few of the parameters' sigmas.
class CalibrationSensitivity {
 public:
  // Rows: u, v, disparity, and right row less left row, which is zero with the true calibration. Pixels per sigma.
  using Jacobian = Eigen::Matrix<double, 4, kCalibrationParameters>;

  // Throws InputError when the calibration cannot be rectified.
  explicit CalibrationSensitivity(const Calibration& given);

  // Derivatives at a measured pixel. Without a disparity (not positive) rows three and four are zero.
  Jacobian at(const StereoPixel& pixel) const;

  const Rig& rig() const { return rig_; }

 private:
  CalibrationSensitivity(const Calibration& given, const Rectification& rectification);

  using ByCamera = Eigen::Matrix<double, 2, kParametersPerCamera>;
  using ByRightCamera = Eigen::Matrix<double, 2, kCalibrationParameters - kRightCamera>;

  Rig rig_;
  bool has_right_ = false;          // false: disparities are depths of a depth camera, independent of the calibration
  PixelGrid<ByCamera> left_;        // derivatives of the left pixel by the left camera's parameters
  PixelGrid<ByRightCamera> right_;  // derivatives of a distant point's right pixel by the right camera's parameters
  // Derivatives of the right camera's centre by the baseline rotation, in baselines, in the rectified left frame.
  Eigen::Matrix<double, 3, 2> centre_by_turn_;
};

}  // namespace byre
