#pragma once

#include "byre/base/executor.h"
#include "byre/base/object_pool.h"
#include "byre/features.h"
#include "byre/geometry/rectified_change.h"
#include "byre/slam/calibration/self_calibration.h"

#include <optional>
#include <vector>

namespace byre {

// A refined calibration and the change of features by it.
struct Recalibration {
  RefinedCalibration refined;
  RectifiedChange from_given;                       // change of features from the given calibration
  RectifiedChange from_present;                     // change of features from the present calibration
  std::vector<RecalibratedFeatures> features = {};  // already converted, ascending by keyframe
};
// before: the state before the refinement.
Recalibration recalibration_by(const RefinedCalibration& refined, const CalibrationState& before);
// Also converts the features of all keyframes of this rig.
Recalibration recalibration_by(const RefinedCalibration& refined, const CalibrationState& before,
                               const MapWindow& whole, int rig);

// Self-calibration during a session: decides when new data suffice for a refinement, and corrects features of frames
// that were rectified by the given calibration. Called from the session's thread.
class Calibrator {
 public:
  Calibrator(const Calibration& given, const SelfCalibrationOptions& options) : options_(options), state_{given} {}

  const CalibrationState& state() const { return state_; }
  const std::optional<RefinedCalibration>& result() const { return result_; }  // the newest; empty before the first
  const SelfCalibrationOptions& options() const { return options_; }

  // The frame by the present calibration; unchanged while that is the given one.
  Frame corrected(const Frame& frame);

  // Called per frame: whether recent left and right images are inconsistent.
  void note_images(bool disagree) {
    if (!from_given_) given_disagrees_ = disagree;
  }
  // Whether the result is not yet reliable. If images were inconsistent with the given calibration, a usual change that
  // explains a few keyframes is no proof: kCloseUntil keyframes are then required.
  bool is_open() const { return !result_ || (given_disagrees_ && last_keyframes_.value_or(0) < kCloseUntil); }

  // Whether the map has grown enough since the last refinement for another one. The first intervals are short, because
  // verdicts are wrong until a wrong calibration is detected.
  bool is_due(int keyframes) const {
    constexpr int kFirst = 7, kStep = 3;
    if (!last_keyframes_) return keyframes >= kFirst;
    return keyframes >= (*last_keyframes_ < kCloseUntil ? *last_keyframes_ + kStep : 2 * *last_keyframes_);
  }
  // Whether a last refinement at the end pays off. A refinement stopped by the end of the session has no result.
  bool is_final_run_useful(int keyframes) const {
    return !last_keyframes_ || is_attempt_open_ || is_moving_ || 4 * keyframes >= 5 * *last_keyframes_;
  }
  void note_attempt(int keyframes) {
    last_keyframes_ = keyframes;
    is_attempt_open_ = true;
  }

  // Makes refined the present calibration; from_given: its change of features from the given one.
  void apply_update(const RefinedCalibration& refined, RectifiedChange from_given);

 private:
  static constexpr int kCloseUntil = 28;  // number of keyframes up to which intervals are short

  SelfCalibrationOptions options_;
  CalibrationState state_;
  std::optional<RefinedCalibration> result_;
  std::optional<RectifiedChange> from_given_;  // empty while the present calibration is the given one
  bool given_disagrees_ = false;               // with the images, while they were rectified by it
  std::optional<int> last_keyframes_;          // keyframes at the last refinement
  bool is_attempt_open_ = false;               // the last refinement has no result yet
  bool is_moving_ = false;                     // the last refinement changed the focal length noticeably
  ObjectPool<Features> features_of_frames_;    // reused memory
};

}  // namespace byre
