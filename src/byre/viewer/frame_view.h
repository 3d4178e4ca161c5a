#pragma once

#include "byre/calibration.h"
#include "byre/viewer/scene.h"

#include <memory>
#include <vector>

namespace byre {

// Makes the images of a run fit what was seen in them: the left ones, rectified as features were taken from them. Call
// it from one thread.
class FrameView {
 public:
  // Throws InputError when the calibration cannot be rectified.
  explicit FrameView(const Calibration& calibration);
  ~FrameView();

  const Rig& rig() const;

  // Precondition: the image is of the calibrated size.
  FrameScene scene_of(const Image& left, const FrameReport& report, const std::vector<SeenPoint>& seen) const;

 private:
  struct State;                   // hides OpenCV
  std::unique_ptr<State> state_;  // constant after construction
};

}  // namespace byre
