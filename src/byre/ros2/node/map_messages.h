#pragma once

#include "byre/floor_plan.h"
#include "byre/io/ros/messages.h"
#include "byre/trajectory.h"

#include <filesystem>
#include <functional>
#include <vector>

#include <Eigen/Core>

namespace byre {

// Occupancy of a floor plan (DrawnFloorPlan) as published by ROS' map_server. Throws InputError if the image cannot be
// read, or pixels are not square or mirrored.
ros::OccupancyGrid grid_of(const FloorPlan& plan);

// Points of a saved map in the published frame.
std::vector<Eigen::Vector3f> points_of(const std::filesystem::path& map, bool in_plan);
ros::PointCloud2 cloud_message(const ros::Header& header, const std::vector<Eigen::Vector3f>& points);

// Path so far; a long one is subsampled.
ros::Path path_message(const ros::Header& header, const Trajectory& trajectory,
                       const std::function<Pose(const Pose&)>& published);

}  // namespace byre
