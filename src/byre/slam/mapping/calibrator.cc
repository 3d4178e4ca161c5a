#include "byre/slam/mapping/calibrator.h"

#include "byre/features/recalibrated.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace byre {

Recalibration recalibration_by(const RefinedCalibration& refined, const CalibrationState& before) {
  return {refined, {before.given, refined.calibration}, {before.present(), refined.calibration}};
}

Recalibration recalibration_by(const RefinedCalibration& refined, const CalibrationState& before,
                               const MapWindow& whole, int rig) {
  Recalibration result = recalibration_by(refined, before);
  for (const WindowKeyframe& seen : whole.keyframes) {
    const std::shared_ptr<const Features>& features = seen.keyframe.frame.features;
    if (seen.keyframe.rig != rig || !features) continue;
    result.features.push_back(
        {seen.id, features, std::make_shared<const Features>(recalibrated(*features, result.from_present))});
  }
  std::ranges::sort(result.features, {}, &RecalibratedFeatures::keyframe);
  return result;
}

Frame Calibrator::corrected(const Frame& frame) {
  if (!from_given_) return frame;
  Frame result = frame;
  const std::shared_ptr<Features>& features = features_of_frames_.take();
  recalibrate_into(*frame.features, *from_given_, *features);
  result.features = features;
  recalibrate_tags(result.tags, *from_given_);
  return result;
}

void Calibrator::apply_update(const RefinedCalibration& refined, RectifiedChange from_given) {
  constexpr double kSettled = 25.0;  // sigmas: 1 % of the focal length
  is_moving_ = std::abs((refined.change - state_.change)[kLeftCamera + kFocal]) > kSettled;
  state_.change = refined.change;
  result_ = refined;
  is_attempt_open_ = false;
  from_given_.emplace(std::move(from_given));
}

}  // namespace byre
