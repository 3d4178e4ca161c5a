#pragma once

#include "byre/pose.h"

#include <optional>

namespace byre {

// The point in the first frame by the midpoint weighted by inverse depth (Lee and Civera 2019), which favours small
// angular errors. Bearings of any length. Empty if the rays meet behind a camera or at an angle below min_angle
// (radians).
std::optional<Eigen::Vector3d> triangulate(const Eigen::Vector3d& bearing_in_first,
                                           const Eigen::Vector3d& bearing_in_second, const Pose& second_from_first,
                                           double min_angle);

}  // namespace byre
