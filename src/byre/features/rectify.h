#pragma once

#include "byre/calibration.h"
#include "byre/features/remap.h"
#include "byre/rig.h"

#include <opencv2/core.hpp>

namespace byre {

// Rectifies images of a calibrated camera or stereo pair to those of an ideal rig, see rectification_of.
class Rectifier {
 public:
  // Throws InputError if no rectification exists: the right camera is not to the right of the left one, the viewing
  // directions differ too much, or the fields of view do not overlap.
  explicit Rectifier(const Calibration& calibration);

  const Rig& rig() const { return rig_; }

  // Returns images that are already rectified without a copy.
  cv::Mat left(const cv::Mat& image) const { return left_.apply(image); }
  cv::Mat right(const cv::Mat& image) const { return right_.apply(image); }  // precondition: there is a right camera

  // Source row of a rectified pixel in the original left image, accurate to a pixel. Precondition: the pixel is in
  // the image.
  float source_row(const Eigen::Vector2f& rectified) const;

 private:
  // Remap of one camera, and its last rectified image.
  struct Side {
    Remap remap;  // empty for images that are already rectified
    mutable cv::Mat rectified;

    cv::Mat apply(const cv::Mat& image) const;
  };

  static Remap make_remap(const Camera& camera, const Eigen::Quaterniond& camera_from_rectified, const Rig& rig);

  Rig rig_;
  Side left_;
  Side right_;
};

}  // namespace byre
