#pragma once

#include "byre/geometry/two_view_match.h"
#include "byre/pose.h"

#include <optional>
#include <span>
#include <vector>

namespace byre {

// The homography ray_in_second ~ homography * ray_in_first of a plane, or of a camera that only rotates: direct linear
// transform on normalised coordinates (Hartley and Zisserman 2004, algorithm 4.2). Scaled to a middle singular value of
// 1. Empty with fewer than four matches or a degenerate configuration (three of four on a line).
std::optional<Eigen::Matrix3d> fit_homography(std::span<const TwoViewMatch> matches);

// The four motions second_from_first for which a plane has this homography, with translations of unit length (Ma,
// Soatto, Kosecka and Sastry 2004, algorithm 5.2). At most two have the plane in front of the first camera. Empty if
// the homography is a rotation, which leaves the translation undetermined.
std::vector<Pose> motions_from_homography(const Eigen::Matrix3d& homography);

}  // namespace byre
