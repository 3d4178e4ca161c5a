#pragma once

#include "byre/features.h"
#include "byre/geometry/rectified_change.h"
#include "byre/slam/self_calibration.h"
#include "byre/workers/executor.h"
#include "byre/workers/shared_pool.h"

#include <memory>
#include <optional>
#include <vector>

namespace byre {

// A refined calibration, and what it makes of what was seen.
struct Recalibration {
  RefinedCalibration refined;
  RectifiedChange from_given;                       // what becomes of features as the calibration given has them
  RectifiedChange from_present;                     // what becomes of features as the one until now has them
  std::vector<RecalibratedFeatures> features = {};  // made already, ascending by keyframe
};
// before: what was known until then.
Recalibration recalibration_by(const RefinedCalibration& refined, const CalibrationState& before);
// The same with features of all keyframes of a map that the rig of this index saw.
Recalibration recalibration_by(const RefinedCalibration& refined, const CalibrationState& before,
                               const MapWindow& whole, int rig);

// Refines the calibration of a session's cameras while it runs: decides when enough new was seen, and corrects the
// features of frames that were rectified by the calibration given. Called from the session's thread.
class Calibrator {
 public:
  Calibrator(const Calibration& given, const SelfCalibrationOptions& options) : options_(options), state_{given, {}} {
    state_.change.setZero();
  }

  const CalibrationState& state() const { return state_; }
  const std::optional<RefinedCalibration>& result() const { return result_; }  // the newest, empty until there is one
  const SelfCalibrationOptions& options() const { return options_; }

  // The frame as the present calibration has it; itself while that is the one given.
  Frame corrected(const Frame& frame);

  // Told with each frame, whether left and right images of late do not fit each other.
  void note_images(bool are_at_odds) {
    if (!from_given_) given_is_at_odds_ = are_at_odds;
  }
  // Whether it is too early to rely on what was found. Where images did not fit by the calibration given, an error of
  // the usual size that makes a few keyframes fit is no proof: as many are asked for as close looks go on for.
  bool is_open() const { return !result_ || (given_is_at_odds_ && last_keyframes_.value_or(0) < kCloseUntil); }

  // Whether a map of so many keyframes has grown enough since the last time for another look. The first ones are close
  // together, as all that was trusted before a calibration is found to be wrong was trusted wrongly.
  bool is_due(int keyframes) const {
    constexpr int kFirst = 7, kStep = 3;
    if (!last_keyframes_) return keyframes >= kFirst;
    return keyframes >= (*last_keyframes_ < kCloseUntil ? *last_keyframes_ + kStep : 2 * *last_keyframes_);
  }
  // The same at the end, when there is no other time. A look that the end cut short has no result.
  bool is_worth_a_last_look(int keyframes) const {
    return !last_keyframes_ || !result_ || 4 * keyframes >= 5 * *last_keyframes_;
  }
  void note_attempt(int keyframes) { last_keyframes_ = keyframes; }

  // From now on that is the present calibration, and from_given how features of the one given change.
  void take_over(const RefinedCalibration& refined, RectifiedChange from_given);

 private:
  static constexpr int kCloseUntil = 28;  // keyframes up to which looks are close together

  SelfCalibrationOptions options_;  // constant after construction
  CalibrationState state_;
  std::optional<RefinedCalibration> result_;
  std::optional<RectifiedChange> from_given_;  // empty while the present calibration is the one given
  bool given_is_at_odds_ = false;              // with the images, when they were last rectified by it
  std::optional<int> last_keyframes_;          // map's size at the last look
  SharedPool<Features> features_of_frames_;    // memory
};

}  // namespace byre
