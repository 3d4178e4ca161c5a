#pragma once

#include <cstddef>
#include <span>

#include <Eigen/Core>

namespace byre {

// Whether a point is inside a polygon, by the even-odd rule.
inline bool is_inside(std::span<const Eigen::Vector2d> corners, const Eigen::Vector2d& point) {
  bool is_odd = false;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const Eigen::Vector2d& from = corners[i];
    const Eigen::Vector2d& to = corners[(i + 1) % corners.size()];
    if ((from.y() > point.y()) == (to.y() > point.y())) continue;
    const double crossing = from.x() + (point.y() - from.y()) / (to.y() - from.y()) * (to.x() - from.x());
    if (point.x() < crossing) is_odd = !is_odd;
  }
  return is_odd;
}

}  // namespace byre
