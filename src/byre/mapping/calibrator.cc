#include "byre/mapping/calibrator.h"

#include "byre/features/recalibrated.h"

#include <utility>

namespace byre {

Frame Calibrator::corrected(const Frame& frame) {
  if (!from_given_) return frame;
  Frame result = frame;
  const std::shared_ptr<Features>& features = features_of_frames_.take();
  recalibrate_into(*frame.features, *from_given_, *features);
  result.features = features;
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
