#pragma once

#include "byre/geometry/two_view_match.h"
#include "byre/pose.h"

#include <array>
#include <vector>

namespace byre {

// Every essential matrix of unit norm (ray_in_second^T * E * ray_in_first = 0) for five matches, at most ten, each
// exact to rounding: cubic constraints solved by eigenvectors (Stewenius, Engels and Nister, ISPRS 2006).
std::vector<Eigen::Matrix3d> five_point_essentials(const std::array<TwoViewMatch, 5>& matches);

Eigen::Matrix3d essential_of(const Pose& second_from_first);

// The four motions second_from_first of an essential matrix, with translations of unit length (Hartley and Zisserman
// 2004, result 9.19). For one of them points lie in front of both cameras.
std::array<Pose, 4> motions_from_essential(const Eigen::Matrix3d& essential);

}  // namespace byre
