#pragma once

#include "byre/floor_plan.h"
#include "byre/ros/messages.h"
#include "byre/trajectory.h"

#include <filesystem>
#include <functional>
#include <vector>

#include <Eigen/Core>

namespace byre {

// The occupancy of a floor plan (DrawnFloorPlan), as ROS' map_server publishes it. Throws InputError if the image
// cannot be read, or its pixels are not upright squares.
ros::OccupancyGrid grid_of(const FloorPlan& plan);

// The points of a kept map, as they lie in the frame that is published.
std::vector<Eigen::Vector3f> points_of(const std::filesystem::path& map, bool in_plan);
ros::PointCloud2 cloud_message(const ros::Header& header, const std::vector<Eigen::Vector3f>& points);

// The way so far; of a long one every so manieth pose.
ros::Path path_message(const ros::Header& header, const Trajectory& trajectory,
                       const std::function<Pose(const Pose&)>& published);

}  // namespace byre
