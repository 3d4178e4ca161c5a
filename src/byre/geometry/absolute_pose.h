#pragma once

#include "byre/geometry/robust.h"
#include "byre/rig.h"

#include <optional>
#include <span>
#include <vector>

namespace byre {

// A point with given position, its pixel in a rectified image and, if measured, its disparity.
struct PointSighting {
  Eigen::Vector3d point_in_world;
  Eigen::Vector2d pixel;
  std::optional<double> disparity{};  // pixels; counts in the reprojection error
};

struct AbsolutePose {
  Pose camera_from_world;
  std::vector<bool> inliers;  // one per sighting
  int inlier_count = 0;
};

// Perspective-three-point in RANSAC, then non-linear refinement on the inliers. Empty with fewer than four inliers or
// degenerate geometry (points on one line or all equal).
std::optional<AbsolutePose> estimate_absolute_pose(std::span<const PointSighting> sightings, const Rig& rig,
                                                   const RansacOptions& options);

}  // namespace byre
