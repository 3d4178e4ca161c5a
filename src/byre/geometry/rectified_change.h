#pragma once

#include "byre/calibration.h"
#include "byre/geometry/pixel_grid.h"
#include "byre/geometry/rectification.h"

namespace byre {

// Where a corner that was found in images rectified by one calibration lies when they are rectified by another.
class RectifiedChange {
 public:
  // Throws InputError when either cannot be rectified. Precondition: both of one camera, or both of two.
  RectifiedChange(const Calibration& before, const Calibration& after);

  struct Corner {
    StereoPixel pixel;        // disparity not positive: seen by the left camera alone
    double row_offset = 0.0;  // the right row less the left one, pixels
  };
  Corner operator()(const Corner& before) const;

  const Rig& rig() const { return rig_; }  // the one after
  // The rectified left cameras lie in one place, and are turned against each other.
  const Pose& after_from_before() const { return after_from_before_; }

 private:
  RectifiedChange(const Calibration& before, const Rectification& rectified_before, const Calibration& after,
                  const Rectification& rectified_after);

  Rig rig_;
  bool has_right_ = false;  // without a right camera a disparity is a depth, which stays
  double zoom_ = 1.0;       // focal length after, by that before
  Pose after_from_before_;
  PixelGrid<Eigen::Vector2d> left_;  // displacement, pixels
  PixelGrid<Eigen::Vector2d> right_;
};

}  // namespace byre
