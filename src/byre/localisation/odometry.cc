#include "byre/localisation/odometry.h"

namespace byre {

void Odometry::start(const Pose& map_from_body) {
  odometry_from_map_ = inverse(map_from_body);
  map_from_body_ = map_from_body;
}

void Odometry::correct(const Pose& map_from_body) {
  odometry_from_map_ = odometry_from_map_ * map_from_body_ * inverse(map_from_body);
  map_from_body_ = map_from_body;
}

Odometry::Step Odometry::follow(const Pose& map_from_body, const std::optional<Pose>& offset) {
  const Pose smooth = without_change_of(offset, map_from_body);
  const double metres = (map_from_body_.translation - smooth.translation).norm();
  map_from_body_ = smooth;
  correct(map_from_body);
  offset_ = offset;
  travelled_ += metres;
  return {smooth, metres};
}

Pose Odometry::without_change_of(const std::optional<Pose>& offset, const Pose& map_from_body) const {
  constexpr double kMaxChange = 0.01;  // metres: less is noise
  if (!offset || !offset_) return map_from_body;
  const double change = (offset->translation - offset_->translation).norm();
  return change > kMaxChange ? map_from_body * inverse(*offset) * *offset_ : map_from_body;
}

}  // namespace byre
