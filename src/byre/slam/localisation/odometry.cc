#include "byre/slam/localisation/odometry.h"

#include "byre/geometry/finite.h"

#include <algorithm>
#include <cmath>

namespace byre {

void Odometry::correct(const Pose& map_from_body) {
  if (!is_finite(map_from_body)) return;
  odometry_from_map_ = odometry_from_map_ * map_from_body_ * inverse(map_from_body);
  map_from_body_ = map_from_body;
}

Odometry::Step Odometry::advance_to(const Pose& map_from_body, const std::optional<Offset>& offset) {
  if (!is_finite(map_from_body)) return {map_from_body_, 0.0};
  const Pose smooth = without_change_of(offset, map_from_body);
  const double metres = (map_from_body_.translation - smooth.translation).norm();
  map_from_body_ = smooth;
  correct(map_from_body);
  offset_ = offset;
  travelled_ += metres;
  return {smooth, metres};
}

void Odometry::move_by_odometry(const Pose& last_from_body, const Pose& map_from_body) {
  if (!is_finite(last_from_body)) return correct(map_from_body);
  correct(map_from_body * inverse(last_from_body));
  advance_to(map_from_body, {});
}

Pose Odometry::without_change_of(const std::optional<Offset>& offset, const Pose& map_from_body) const {
  constexpr double kLeastChange = 0.01;  // metres; smaller changes are noise
  constexpr double kSigmas = 3.0;
  if (!offset || !offset_) return map_from_body;
  const Pose &now = offset->online_from_body, &before = offset_->online_from_body;
  const double change = (now.translation - before.translation).norm();
  const double noise = kSigmas * std::hypot(offset->sigma, offset_->sigma);
  return change > std::max(kLeastChange, noise) ? map_from_body * inverse(now) * before : map_from_body;
}

}  // namespace byre
