#pragma once

#include "byre/geometry/two_view_match.h"
#include "byre/pose.h"

#include <array>
#include <vector>

namespace byre {

// Every essential matrix (ray_in_second^T * E * ray_in_first = 0) that five matches allow, at most ten, each exact to
// rounding: the cubic constraints solved by eigenvectors (Stewenius, Engels and Nister, ISPRS 2006). Of unit norm.
std::vector<Eigen::Matrix3d> five_point_essentials(const std::array<TwoViewMatch, 5>& matches);

Eigen::Matrix3d essential_of(const Pose& second_from_first);

// The four motions second_from_first an essential matrix stands for, their translations of unit length (Hartley and
// Zisserman 2004, result 9.19); with one of them points lie in front of both cameras.
std::array<Pose, 4> motions_from_essential(const Eigen::Matrix3d& essential);

}  // namespace byre
