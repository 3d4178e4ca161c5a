#include "byre/slam/mapping/rolling_shutter_corrector.h"

#include <memory>

namespace byre {

void RollingShutterCorrector::refine(const RefinedCalibration& known) {
  known_ = known;
  estimator_.emplace(readout_time_);
}

std::optional<RefinedCalibration> RollingShutterCorrector::refined(std::optional<RefinedCalibration> otherwise) const {
  if (!known_ || readout_time_ == known_->calibration.readout_time) return otherwise;
  if (!otherwise) otherwise = known_;
  otherwise->calibration.readout_time = readout_time_;
  return otherwise;
}

Frame RollingShutterCorrector::corrected(const Frame& frame, const Rig& rig, const CameraMotion& motion) {
  motion_ = motion;
  if (!is_rolling() || motion.velocity.isZero(0.0)) return frame;
  Frame result = frame;
  const std::shared_ptr<Features>& features = features_of_frames_.take();
  correct_rolling_shutter(*frame.features, rig, motion, readout_time_, *features);
  result.features = features;
  return result;
}

void RollingShutterCorrector::note(const Frame& frame, const Rig& rig, const TrackedFrame& tracked, const MapView& map,
                                   const Vector6& velocity) {
  if (!estimator_ || has_change()) return;
  estimator_->note(readout_evidence(frame, rig, tracked, map, velocity));
}

void RollingShutterCorrector::apply_update(const Rig& rig, MapGraph& online) {
  const double change = estimator_->readout_time() - readout_time_;
  for (const auto& [id, motion] : motions_) {
    const Keyframe* const keyframe = online.find_keyframe(id);
    if (keyframe == nullptr) continue;
    online.move_features(id, correct_rolling_shutter(*keyframe->frame.features, rig, motion, change));
  }
  readout_time_ = estimator_->readout_time();
}

}  // namespace byre
