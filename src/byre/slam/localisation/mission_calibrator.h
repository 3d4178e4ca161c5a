#pragma once

#include "byre/base/job_slot.h"
#include "byre/slam/calibration/calibration_on_map.h"
#include "byre/slam/mapping/calibrator.h"

#include <optional>

namespace byre {

// Refines the calibration of a mission's cameras on the points of the offline map, frame by frame. The change of
// rectified features takes long to compute, so it is a job.
class MissionCalibrator {
 public:
  MissionCalibrator(const Calibration& given, double prior_sigmas)
      : on_map_(given, prior_sigmas), calibrator_(given, {}) {}

  JobState& job() { return job_; }  // for the owner to run

  Frame corrected(const Frame& frame) { return calibrator_.corrected(frame); }
  const std::optional<RefinedCalibration>& result() const { return calibrator_.result(); }

  // See CalibrationOnMap. For the features of a corrected frame.
  double length_sigma(const Features& features) const {
    return on_map_.length_sigma(features, calibrator_.state().change);
  }

  // Adds a corrected frame whose pose is beyond doubt.
  void note(const Frame& frame, const Rig& rig, const TrackedFrame& tracked, const MapView& map);

  // Change of the rectified camera from this frame on.
  struct Switch {
    Pose after_from_before;  // rotation only
    Rig rig;
  };
  std::optional<Switch> collect();  // once per frame; empty without a better calibration

 private:
  struct Outcome {
    RefinedCalibration refined;
    RectifiedChange from_given;
    Pose after_from_before;
  };

  CalibrationOnMap on_map_;
  Calibrator calibrator_;
  JobSlot<Outcome> job_;
  int next_frames_ = 20;  // frames noted before the next estimate
};

}  // namespace byre
