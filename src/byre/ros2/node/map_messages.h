#pragma once

#include "byre/floor_plan.h"
#include "byre/io/ros/messages.h"
#include "byre/map/map_file.h"
#include "byre/map/plan/occupancy_grid.h"
#include "byre/trajectory.h"

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <vector>

#include <Eigen/Core>

namespace byre {

// Occupancy of a floor plan (DrawnFloorPlan) as published by ROS' map_server. Throws InputError if the image cannot be
// read, or pixels are not square or mirrored.
ros::OccupancyGrid grid_of(const FloorPlan& plan);

// Occupancy computed from a map, in the published frame: that of the floor plan if in_plan and the map is registered on
// one, else the map frame, in which the origin is tilted as the floor is. Throws InputError for a map without metric
// scale that is not on a plan, one that was not driven on a floor, and as occupancy_grid does.
ros::OccupancyGrid grid_of(const StoredMap& stored, bool in_plan, const GridOptions& options);
ros::OccupancyGrid grid_of(const OccupancyGrid& grid, bool in_plan);

// One unknown cell, which replaces a grid that no longer holds.
ros::OccupancyGrid unknown_grid();

// Point of a cloud: position in the published frame, and grey value from 0 to 255 (kUnknownGrey without one).
using CloudPoint = Eigen::Vector4f;
CloudPoint cloud_point(const Eigen::Vector3d& position, std::optional<std::uint8_t> grey);

// Points of a saved map.
std::vector<CloudPoint> points_of(const std::filesystem::path& map, bool in_plan);
ros::PointCloud2 cloud_message(const ros::Header& header, const std::vector<CloudPoint>& points);

// Path so far; a long one is subsampled.
ros::Path path_message(const ros::Header& header, const Trajectory& trajectory,
                       const std::function<Pose(const Pose&)>& published);

}  // namespace byre
