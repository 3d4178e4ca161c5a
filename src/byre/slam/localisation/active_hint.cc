#include "byre/slam/localisation/active_hint.h"

#include <cmath>

namespace byre {

bool is_near(const PoseHint& hint, const Pose& map_from_body) {
  return (map_from_body.translation - hint.map_from_body.translation).norm() <= hint.radius &&
         angle_between(map_from_body.rotation, hint.map_from_body.rotation) <= hint.turn;
}

void ActiveHint::set_hint(const PoseHint& hint) {
  const Pose& pose = hint.map_from_body;
  const bool is_finite = pose.translation.allFinite() && pose.rotation.coeffs().allFinite() &&
                         std::isfinite(hint.radius) && std::isfinite(hint.turn) && std::isfinite(hint.seconds);
  hint_ = is_finite ? std::optional(hint) : std::nullopt;
  first_frame_.reset();
}

void ActiveHint::expire(Timestamp frame) {
  if (!hint_) return;
  if (!first_frame_) first_frame_ = frame;
  if (to_seconds(frame - *first_frame_) >= hint_->seconds) hint_.reset();
}

}  // namespace byre
