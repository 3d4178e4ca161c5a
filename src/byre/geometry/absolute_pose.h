#pragma once

#include "byre/geometry/robust.h"
#include "byre/rig.h"

#include <optional>
#include <span>
#include <vector>

namespace byre {

// A known point seen at a pixel of a rectified image, and in the right image where there is a disparity.
struct PointSighting {
  Eigen::Vector3d point_in_world;
  Eigen::Vector2d pixel;
  std::optional<double> disparity{};  // pixels; must agree too
};

struct AbsolutePose {
  Pose camera_from_world;
  std::vector<bool> inliers;  // one per sighting
  int inlier_count = 0;
};

// Perspective three-point inside RANSAC, then a non-linear refinement on the inliers. Empty when fewer than
// four sightings agree or the geometry is degenerate (points on one line, all the same).
std::optional<AbsolutePose> estimate_absolute_pose(std::span<const PointSighting> sightings, const Rig& rig,
                                                   const RansacOptions& options);

}  // namespace byre
