#pragma once

#include "byre/floor_plan.h"

#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>

namespace byre {

// A point in the frame of a grid; z is its height above the floor. Metres.
struct GridPoint {
  Eigen::Vector3d position = Eigen::Vector3d::Zero();
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  std::vector<std::uint32_t> scans;  // indices of the cameras that observe it, ascending
  bool is_obstacle = false;          // whether it makes cells occupied; other points only end rays
};

struct GridLayers {
  double low = 0.0;  // heights of the lowest layer's bottom and the highest one's top, metres
  double high = 0.0;
  double largest_gap = 0.0;  // metres, between points on a line that are joined; zero joins none
};

// Occupancy of the cells of an upright grid with square pixels, see occupancy_grid(). cameras: their positions, z above
// the floor.
std::vector<std::int8_t> occupancy_by_rays(const FloorPlan& grid, std::span<const GridPoint> points,
                                           std::span<const Eigen::Vector3d> cameras, const GridLayers& layers);

}  // namespace byre
