#include "byre/slam/localisation/mission_calibrator.h"

#include <utility>

namespace byre {

// Estimates double their interval: a few more frames do not change the result of many.
void MissionCalibrator::note(const Frame& frame, const Rig& rig, const TrackedFrame& tracked, const MapView& map) {
  constexpr double kLeastChange = 0.3;  // sigmas of the parameters, about 0.01 pixels
  on_map_.add(frame, rig, tracked, map, calibrator_.state().change);
  if (on_map_.frames() < next_frames_ || !job_.is_idle()) return;
  next_frames_ = 2 * on_map_.frames();
  const RefinedCalibration refined = on_map_.estimate();
  if ((refined.change - calibrator_.state().change).norm() < kLeastChange) return;
  job_.request([refined, state = calibrator_.state()] {
    return Outcome{refined,
                   {state.given, refined.calibration},
                   {rectification_of(refined.calibration).left_from_rectified.conjugate() *
                        rectification_of(state.present()).left_from_rectified,
                    Eigen::Vector3d::Zero()}};
  });
}

std::optional<MissionCalibrator::Switch> MissionCalibrator::collect() {
  auto finished = job_.collect();
  if (!finished) return std::nullopt;
  Outcome& outcome = finished->result;
  const Switch result{outcome.after_from_before, outcome.from_given.rig()};
  calibrator_.apply_update(outcome.refined, std::move(outcome.from_given));
  return result;
}

}  // namespace byre
