#pragma once

#include "byre/calibration.h"
#include "byre/viewer/scene.h"

#include <memory>
#include <vector>

namespace byre {

// Rectifies left images with the calibration used for features, so that features match the images. Call it from one
// thread.
class FrameView {
 public:
  // Throws InputError if the calibration cannot be rectified.
  explicit FrameView(const Calibration& calibration);
  ~FrameView();

  const Rig& rig() const;

  // Precondition: the image has the calibrated size.
  FrameScene scene_of(const Image& left, const FrameReport& report, const std::vector<SeenPoint>& seen) const;

 private:
  struct State;                   // hides OpenCV
  std::unique_ptr<State> state_;  // constant after construction
};

}  // namespace byre
