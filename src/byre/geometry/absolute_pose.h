#pragma once

#include "byre/rig.h"

#include <cstdint>
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

// Results depend on input and seed alone.
struct RansacOptions {
  int max_iterations = 1000;
  double confidence = 0.999;
  double max_error = 4.0;  // pixels
  std::uint64_t seed = 0;
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
