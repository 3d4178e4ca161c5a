#pragma once

#include "byre/map/map_graph.h"
#include "byre/odometry/stationary_detector.h"

#include <optional>
#include <string>
#include <vector>

#include <Eigen/Geometry>

namespace byre {

// Floor under a robot, estimated from its path and the attitude of its camera. Lengths in the map's unit.
struct DrivingPlane {
  std::vector<Eigen::Vector3d> path_in_map;                // positions to which the plane was fitted
  Eigen::Vector3d point_in_map = Eigen::Vector3d::Zero();  // mean of the path
  Eigen::Vector3d up_in_map = Eigen::Vector3d::UnitZ();    // unit length
  // Inverse covariance of the up direction, in the map's axes, 1/square radians. Meaningless along up_in_map itself.
  Eigen::Matrix3d up_information = Eigen::Matrix3d::Identity();
  // Standard deviations of the path along its longest direction, across it, and out of the plane.
  double length = 0.0;
  double width = 0.0;
  double thickness = 0.0;
};

inline constexpr double kUprightSigma = 0.05;  // radians, tilt of a camera mounted to look horizontally

// Fits the plane to positions on a path; there must be one. On a line, the rotation about it comes from
// up_of_rig_in_map (unit length), whose standard deviation is up_sigma (radians), and which also selects the upper side
// of the plane.
DrivingPlane fit_driving_plane(std::vector<Eigen::Vector3d> path_in_map, const Eigen::Vector3d& up_of_rig_in_map,
                               double up_sigma = kUprightSigma);

// Path of the body in a map, with the mean up direction of its base, or else of its images. base: up axis of the base.
// Empty without keyframes or a common attitude.
std::optional<DrivingPlane> fit_driving_plane(const MapGraph& map, const std::optional<UpInBody>& base);
// The same. Throws InputError naming the map if there is no plane.
DrivingPlane require_driving_plane(const MapGraph& map, const std::optional<UpInBody>& base, const std::string& name);

Eigen::Vector3d body_at(const MapGraph& map, const Keyframe& keyframe);

}  // namespace byre
