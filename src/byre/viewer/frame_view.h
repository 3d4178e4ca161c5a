#pragma once

#include "byre/features/rectify.h"
#include "byre/viewer/scene.h"

#include <vector>

namespace byre {

// Rectifies left images with the calibration used for features, so that features match the images. Call it from one
// thread.
class FrameView {
 public:
  // Throws InputError if the calibration cannot be rectified.
  explicit FrameView(const Calibration& calibration) : rectifier_(calibration) {}

  const Rig& rig() const { return rectifier_.rig(); }

  // Precondition: the image has the calibrated size.
  FrameScene scene_of(const Image& left, const FrameReport& report, const std::vector<SeenPoint>& seen) const;

 private:
  Rectifier rectifier_;
};

}  // namespace byre
