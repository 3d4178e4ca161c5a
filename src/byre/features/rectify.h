#pragma once

#include "byre/calibration.h"
#include "byre/features/remap.h"
#include "byre/rig.h"

#include <optional>

#include <opencv2/core.hpp>

namespace byre {

// Turns images of a calibrated camera or stereo pair into those of an ideal rig, see rectification_of.
class Rectifier {
 public:
  // Throws InputError when no rectification exists: the right camera is not to the right of the left one, the cameras
  // look in directions too far apart, or their fields do not overlap.
  explicit Rectifier(const Calibration& calibration);

  const Rig& rig() const { return rig_; }

  // Images that are rectified already are handed on without a copy.
  cv::Mat left(const cv::Mat& image) const { return left_.apply(image); }
  cv::Mat right(const cv::Mat& image) const { return right_.apply(image); }  // precondition: there is a right camera

  // The row of the left image, as it was taken, that a pixel of the rectified one comes from; to a pixel.
  // Precondition: the pixel is in the image.
  float source_row(const Eigen::Vector2f& rectified) const;

 private:
  // How one camera's images are made, and the last one that was.
  struct Side {
    Remap remap;  // empty where images are rectified already
    mutable cv::Mat rectified;

    cv::Mat apply(const cv::Mat& image) const;
  };

  static Remap make_remap(const Camera& camera, const Eigen::Quaterniond& camera_from_rectified, const Rig& rig);

  Rig rig_;
  Side left_;
  Side right_;
};

}  // namespace byre
