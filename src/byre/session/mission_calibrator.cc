#include "byre/session/mission_calibrator.h"

#include <utility>

namespace byre {

MissionCalibrator::MissionCalibrator(const Calibration& given, double prior_sigmas, std::unique_ptr<Executor> executor)
    : on_map_(given, prior_sigmas), calibrator_(given, {}), executor_(std::move(executor)) {}

// Looks become rare: what many frames have told, a few more do not change.
void MissionCalibrator::note(const Frame& frame, const Rig& rig, const TrackedFrame& tracked, const MapView& map) {
  constexpr double kLeastChange = 0.3;  // sigmas of the parameters: a hundredth of a pixel or so
  on_map_.add(frame, rig, tracked, map, calibrator_.state().change);
  if (on_map_.frames() < next_frames_ || !executor_->idle()) return;
  next_frames_ = 2 * on_map_.frames();
  const RefinedCalibration refined = on_map_.estimate();
  if ((refined.change - calibrator_.state().change).norm() < kLeastChange) return;
  outcome_ = std::make_shared<Outcome>(Outcome{refined, {}, {}});
  executor_->submit([outcome = outcome_, state = calibrator_.state()] {
    outcome->from_given.emplace(state.given, outcome->refined.calibration);
    outcome->after_from_before = {rectification_of(outcome->refined.calibration).left_from_rectified.conjugate() *
                                      rectification_of(state.present()).left_from_rectified,
                                  Eigen::Vector3d::Zero()};
    return MapDelta{};
  });
}

std::optional<MissionCalibrator::Switch> MissionCalibrator::collect() {
  if (!executor_->collect()) return std::nullopt;
  const Switch result{outcome_->after_from_before, outcome_->from_given->rig()};
  calibrator_.take_over(outcome_->refined, *std::move(outcome_->from_given));
  outcome_.reset();
  return result;
}

}  // namespace byre
