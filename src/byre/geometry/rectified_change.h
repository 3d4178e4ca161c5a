#pragma once

#include "byre/calibration.h"
#include "byre/geometry/pixel_grid.h"
#include "byre/geometry/rectification.h"

namespace byre {

// Maps corners of images rectified by one calibration to images rectified by another.
class RectifiedChange {
 public:
  // Throws InputError when either cannot be rectified. Precondition: both monocular, or both stereo.
  RectifiedChange(const Calibration& before, const Calibration& after);

  struct Corner {
    StereoPixel pixel;        // disparity not positive: left camera only
    double row_offset = 0.0;  // right row less left row, pixels
  };
  Corner operator()(const Corner& before) const;

  const Rig& rig() const { return rig_; }  // rig after the change
  // A pure rotation: the rectified left cameras share their centre.
  const Pose& after_from_before() const { return after_from_before_; }

 private:
  RectifiedChange(const Calibration& before, const Rectification& rectified_before, const Calibration& after,
                  const Rectification& rectified_after);

  Rig rig_;
  bool has_right_ = false;  // false: disparities are depths of a depth camera, which stay
  double zoom_ = 1.0;       // focal length after over before
  Pose after_from_before_;
  PixelGrid<Eigen::Vector2d> left_;  // displacement, pixels
  PixelGrid<Eigen::Vector2d> right_;
};

}  // namespace byre
