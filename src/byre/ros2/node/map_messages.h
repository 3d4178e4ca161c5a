#pragma once

#include "byre/floor_plan.h"
#include "byre/io/ros/messages.h"
#include "byre/map/map_file.h"
#include "byre/map/plan/occupancy_grid.h"
#include "byre/trajectory.h"

#include <filesystem>
#include <functional>
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

// Points of a saved map in the published frame.
std::vector<Eigen::Vector3f> points_of(const std::filesystem::path& map, bool in_plan);
ros::PointCloud2 cloud_message(const ros::Header& header, const std::vector<Eigen::Vector3f>& points);

// Path so far; a long one is subsampled.
ros::Path path_message(const ros::Header& header, const Trajectory& trajectory,
                       const std::function<Pose(const Pose&)>& published);

}  // namespace byre
