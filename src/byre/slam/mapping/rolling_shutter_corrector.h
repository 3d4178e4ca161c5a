#pragma once

#include "byre/base/object_pool.h"
#include "byre/features/rolling_shutter.h"
#include "byre/geometry/calibration_change.h"
#include "byre/map/map_graph.h"
#include "byre/slam/calibration/readout_estimate.h"

#include <map>
#include <optional>

namespace byre {

// Rolling shutter of a session's camera: moves corners to their positions at the time of the middle row, and estimates
// the readout time. Called from the session's thread.
class RollingShutterCorrector {
 public:
  explicit RollingShutterCorrector(double readout_time) : readout_time_(readout_time) {}

  double readout_time() const { return readout_time_; }  // seconds, as used for corrected()
  bool is_rolling() const { return readout_time_ != 0.0; }

  // Starts the estimation of the readout time. known: the camera's calibration with the present readout time.
  void refine(const RefinedCalibration& known);
  // The refined calibration with the estimated readout time: `otherwise`, if given, else that of refine(). Returns
  // `otherwise` while the readout time is unchanged.
  std::optional<RefinedCalibration> refined(std::optional<RefinedCalibration> otherwise) const;

  // The frame as if all rows were exposed at once, for a camera with this motion.
  Frame corrected(const Frame& frame, const Rig& rig, const CameraMotion& motion);

  // The frame corrected last became this keyframe.
  void note_keyframe(KeyframeId id) { motions_[id] = motion_; }

  // Adds a frame with a reliable pose and the camera's velocity to the estimation.
  void note(const Frame& frame, const Rig& rig, const TrackedFrame& tracked, const MapView& map,
            const Vector6& velocity);

  // Whether a better readout time is available. apply_update() applies it to all noted keyframes.
  bool has_change() const { return estimator_ && estimator_->readout_time() != readout_time_; }
  void apply_update(const Rig& rig, MapGraph& online);

 private:
  double readout_time_;                         // seconds, used for corners so far
  std::optional<RefinedCalibration> known_;     // as given to refine()
  std::optional<ReadoutEstimator> estimator_;   // empty: not estimated; ahead of readout_time_ until apply_update()
  CameraMotion motion_;                         // during the last frame
  std::map<KeyframeId, CameraMotion> motions_;  // during each keyframe's frame
  ObjectPool<Features> features_of_frames_;     // reused memory
};

}  // namespace byre
