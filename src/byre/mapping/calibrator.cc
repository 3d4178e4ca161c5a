#include "byre/mapping/calibrator.h"

#include "byre/features/recalibrated.h"

#include <utility>

namespace byre {

Frame Calibrator::corrected(const Frame& frame) const {
  if (!from_given_) return frame;
  Frame result = frame;
  result.features = std::make_shared<const Features>(recalibrated(*frame.features, *from_given_));
  return result;
}

void Calibrator::take_over(const RefinedCalibration& refined, RectifiedChange from_given) {
  state_.change = refined.change;
  result_ = refined;
  from_given_.emplace(std::move(from_given));
}

RectifiedChange Calibrator::take_over(const RefinedCalibration& refined) {
  const Calibration before = state_.present();
  take_over(refined, {state_.given, refined.calibration});
  return {before, refined.calibration};
}

}  // namespace byre
