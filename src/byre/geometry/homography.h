#pragma once

#include "byre/geometry/two_view_match.h"
#include "byre/pose.h"

#include <optional>
#include <span>
#include <vector>

namespace byre {

// The mapping ray_in_second ~ homography * ray_in_first of a plane, or of a camera that only turns: the direct linear
// transform on normalised coordinates (Hartley and Zisserman 2004, algorithm 4.2). Scaled so that its middle singular
// value is 1. Empty with fewer than four matches, or where they do not determine it (three of four on a line).
std::optional<Eigen::Matrix3d> fit_homography(std::span<const TwoViewMatch> matches);

// The four motions second_from_first by which a plane gives this homography, their translations of unit length (Ma,
// Soatto, Kosecka and Sastry 2004, algorithm 5.2); two at most have the plane in front of the first camera. Empty for a
// homography that is a rotation: then there is no translation to tell.
std::vector<Pose> motions_from_homography(const Eigen::Matrix3d& homography);

}  // namespace byre
