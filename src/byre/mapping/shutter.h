#pragma once

#include "byre/features/rolling_shutter.h"
#include "byre/geometry/calibration_change.h"
#include "byre/map/map.h"
#include "byre/slam/readout_estimate.h"
#include "byre/workers/shared_pool.h"

#include <map>
#include <optional>

namespace byre {

// The rolling shutter of a session's camera: has corners where the middle row's time would show them, and finds out how
// long the rows take to be read. Called from the session's thread.
class Shutter {
 public:
  explicit Shutter(double readout_time) : readout_time_(readout_time) {}

  double readout_time() const { return readout_time_; }  // seconds, by which corners are corrected
  bool is_rolling() const { return readout_time_ != 0.0; }

  // From now on the readout time is refined from what is seen; known: of the camera, with the time as it is.
  void refine(const RefinedCalibration& known);
  // What is known of the camera by now: what was refined otherwise, if anything, with the readout time as it is found.
  std::optional<RefinedCalibration> refined(std::optional<RefinedCalibration> otherwise) const;

  // The frame as all rows at once would show it, seen by a camera that moves like that.
  Frame corrected(const Frame& frame, const Rig& rig, const CameraMotion& motion);

  // The frame corrected last has become a keyframe.
  void note_keyframe(KeyframeId id) { motions_[id] = motion_; }

  // That frame's pose, beyond doubt, and how the camera moved.
  void note(const Frame& frame, const Rig& rig, const TrackedFrame& tracked, const MapView& map,
            const Vector6& velocity);

  // Whether there is a better readout time; take_over has all keyframes that were noted seen by it.
  bool has_change() const { return estimator_ && estimator_->readout_time() != readout_time_; }
  void take_over(const Rig& rig, Map& online);

 private:
  double readout_time_;                         // seconds, that the corners lie by
  std::optional<RefinedCalibration> known_;     // as it was, where the time is refined
  std::optional<ReadoutEstimator> estimator_;   // where it is refined; ahead of it until that is taken over
  CameraMotion motion_;                         // while the last frame was taken
  std::map<KeyframeId, CameraMotion> motions_;  // while keyframes were
  SharedPool<Features> features_of_frames_;     // memory
};

}  // namespace byre
