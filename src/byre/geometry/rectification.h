#pragma once

#include "byre/calibration.h"
#include "byre/rig.h"

namespace byre {

// Rectification of a camera or stereo pair to an ideal rig: no distortion, one focal length, rows aligned. The rig has
// the largest field of view with all pixels defined in both images. A camera mounted upside down is turned; one camera
// above the other gives images turned by a quarter, with width and height exchanged. A depth camera gives the rig its
// baseline.
struct Rectification {
  Rig rig;
  Eigen::Quaterniond left_from_rectified = Eigen::Quaterniond::Identity();
  Eigen::Quaterniond right_from_rectified = Eigen::Quaterniond::Identity();  // unused without a right camera
  bool is_identity = false;                                                  // the images need no rectification
};

// Throws InputError if the right camera is to the left of the left one, in front of it or behind it, the optical axes
// differ too much, or the fields of view do not overlap.
Rectification rectification_of(const Calibration& calibration);
// Whether rectification_of succeeds.
bool can_be_rectified(const Calibration& calibration);

}  // namespace byre
