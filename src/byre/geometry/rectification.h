#pragma once

#include "byre/calibration.h"
#include "byre/rig.h"

namespace byre {

// How a calibrated camera or pair becomes an ideal rig: no distortion, one focal length, rows aligned. The rig's field
// of view is the largest in which every pixel of both images is defined. A depth camera gives the rig its baseline.
struct Rectification {
  Rig rig;
  Eigen::Quaterniond left_from_rectified = Eigen::Quaterniond::Identity();
  Eigen::Quaterniond right_from_rectified = Eigen::Quaterniond::Identity();  // unused without a right camera
  bool is_identity = false;                                                  // the images are those of the rig already
};

// Throws InputError when none exists: the right camera is not to the right of the left one, the cameras look in
// directions too far apart, or their fields do not overlap.
Rectification rectification_of(const Calibration& calibration);

}  // namespace byre
