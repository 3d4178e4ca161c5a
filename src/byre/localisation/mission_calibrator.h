#pragma once

#include "byre/mapping/calibrator.h"
#include "byre/slam/calibration_on_map.h"
#include "byre/workers/worker.h"

#include <memory>
#include <optional>

namespace byre {

// Refines the calibration of a mission's cameras on the points of its offline map, a little with each frame. What takes
// long, how features change by it, is worked out beside. Called from the session's thread.
class MissionCalibrator {
 public:
  MissionCalibrator(const Calibration& given, double prior_sigmas, std::unique_ptr<Executor> executor);

  Frame corrected(const Frame& frame) { return calibrator_.corrected(frame); }
  const std::optional<RefinedCalibration>& result() const { return calibrator_.result(); }

  // A frame, as corrected, whose pose is beyond doubt.
  void note(const Frame& frame, const Rig& rig, const TrackedFrame& tracked, const MapView& map);

  // How the rectified camera changes from this frame on.
  struct Switch {
    Pose after_from_before;  // a turn
    Rig rig;
  };
  std::optional<Switch> collect();  // once per frame; empty unless there is a better calibration
  void finish() { worker_.finish(); }

 private:
  // What a job came to.
  struct Outcome {
    RefinedCalibration refined;
    RectifiedChange from_given;
    Pose after_from_before;
  };

  CalibrationOnMap on_map_;
  Calibrator calibrator_;
  Worker<Outcome> worker_;
  int next_frames_ = 60;  // frames noted until the next look
};

}  // namespace byre
