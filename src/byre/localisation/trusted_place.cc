#include "byre/localisation/trusted_place.h"

namespace byre {

std::optional<PlaceBounds::Way> TrustedPlace::way_from_there() const {
  if (!place_) return std::nullopt;
  return PlaceBounds::Way{*place_, max_speed_};
}

bool TrustedPlace::is_news(Doubt refused, Verdict verdict) {
  if (verdict != Verdict::untrusted) told_ = Doubt::none;
  if (refused == Doubt::none || refused == told_) return false;
  told_ = refused;
  return true;
}

}  // namespace byre
