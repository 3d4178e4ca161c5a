#include "byre/session/global_lane.h"

#include <cassert>
#include <utility>

namespace byre {

void GlobalLane::close_loops(const Map& map, const std::vector<LoopEdge>& loops) {
  assert(idle());
  snapshot_ = std::make_shared<const MapWindow>(whole_map(map));
  executor_->submit([snapshot = snapshot_, is_hurried = is_hurried_, loops, options = options_] {
    return adjust_map(*snapshot, loops, options, [&is_hurried] { return is_hurried->load(); });
  });
}

void GlobalLane::calibrate(const MapView& map, const CalibrationState& state, int rig,
                           const SelfCalibrationOptions& options) {
  assert(idle());
  calibration_ = std::make_shared<std::optional<RefinedCalibration>>();
  calibration_is_ready_ = false;
  const auto snapshot = std::make_shared<const MapWindow>(whole_map(map));
  executor_->submit([snapshot, state, rig, options, result = calibration_, is_hurried = is_hurried_] {
    *result = self_calibrate(*snapshot, state, rig, options, [&is_hurried] { return is_hurried->load(); });
    return MapDelta{};
  });
}

std::optional<RefinedCalibration> GlobalLane::take_calibration() {
  if (!calibration_is_ready_) return std::nullopt;
  calibration_is_ready_ = false;
  return *std::exchange(calibration_, nullptr);
}

void GlobalLane::collect() {
  if (auto finished = executor_->collect()) note(std::move(*finished));
}

void GlobalLane::finish() {
  if (auto finished = executor_->finish()) note(std::move(*finished));
}

void GlobalLane::note(FinishedJob finished) {
  if (calibration_) {
    calibration_is_ready_ = true;
  } else {
    correction_ = std::move(finished.delta);
  }
}

AppliedCorrection GlobalLane::apply(Map& online) {
  assert(is_waiting());
  const MapDelta correction = *std::exchange(correction_, std::nullopt);
  LengthChanges changes = apply_correction(correction, *snapshot_, online);
  snapshot_.reset();
  return {correction, std::move(changes)};
}

}  // namespace byre
