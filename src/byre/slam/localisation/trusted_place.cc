#include "byre/slam/localisation/trusted_place.h"

namespace byre {

std::optional<PlaceBounds::Reach> TrustedPlace::reach_from_there() const {
  if (!place_) return std::nullopt;
  return PlaceBounds::Reach{*place_, max_speed_};
}

bool TrustedPlace::is_new_refusal(DistrustReason refused, Verdict verdict) {
  if (verdict != Verdict::untrusted) reported_ = DistrustReason::none;
  if (refused == DistrustReason::none || refused == reported_) return false;
  reported_ = refused;
  return true;
}

}  // namespace byre
