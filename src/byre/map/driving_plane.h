#pragma once

#include "byre/map/map.h"

#include <optional>
#include <vector>

#include <Eigen/Geometry>

namespace byre {

// The floor under a robot, as far as its path and the way its camera is held tell it. Lengths in the map's unit.
struct DrivingPlane {
  std::vector<Eigen::Vector3d> path_in_map;                // positions that the plane was fitted to
  Eigen::Vector3d point_in_map = Eigen::Vector3d::Zero();  // mean of the path
  Eigen::Vector3d up_in_map = Eigen::Vector3d::UnitZ();    // unit length
  // Inverse of the covariance of up_in_map, in the map's axes, 1/square radians: how far its tip may be off in a
  // direction. Nothing is said along up_in_map itself.
  Eigen::Matrix3d up_information = Eigen::Matrix3d::Identity();
  // Spread of the path (standard deviations) along its longest direction, across that, and out of the plane.
  double length = 0.0;
  double width = 0.0;
  double thickness = 0.0;
};

// Fits the plane to positions on a path. Where that is a line, the turn about the line is left to up_of_rig_in_map
// (unit length), which is taken to be right within a few degrees; it also tells which side of the plane is up.
// Precondition: there is a position.
DrivingPlane fit_driving_plane(std::vector<Eigen::Vector3d> path_in_map, const Eigen::Vector3d& up_of_rig_in_map);

// The same for the path of the body in a map, with "up" as the images of its keyframes have it on average. Empty
// without keyframes, or when these are held in all directions.
std::optional<DrivingPlane> fit_driving_plane(const Map& map);

// Position of the body at a keyframe.
Eigen::Vector3d body_at(const Map& map, const Keyframe& keyframe);

}  // namespace byre
