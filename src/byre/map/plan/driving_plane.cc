#include "byre/map/plan/driving_plane.h"

#include "byre/geometry/decompositions.h"
#include "byre/input_error.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <span>
#include <utility>

#include <Eigen/LU>

namespace byre {
namespace {

constexpr double kFloorUnevenness = 0.002;    // least unevenness, relative to the path's length
constexpr double kIndependentPositions = 50;  // most that count; neighbouring positions share their errors
constexpr double kLeastCommonUp = 0.5;        // length of the mean of unit vectors

Eigen::Vector3d mean_of(std::span<const Eigen::Vector3d> points) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3d& point : points) sum += point;
  return sum / static_cast<double>(points.size());
}

Eigen::Matrix3d covariance_of(std::span<const Eigen::Vector3d> points, const Eigen::Vector3d& mean) {
  Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
  for (const Eigen::Vector3d& point : points) sum += (point - mean) * (point - mean).transpose();
  return sum / static_cast<double>(points.size());
}

double root(double variance) {
  return std::sqrt(std::max(variance, 0.0));  // rounding may make zero negative
}

}  // namespace

// Minimises |up - up_of_rig|^2 / up_sigma^2 + sum over the path ((position - mean) . up)^2 / unevenness^2 for |up| =
// 1. Stationary points solve a linear system except for the Lagrange multiplier of the constraint. The multiplier is
// the least eigenvalue of the path's term if the path determines the plane, else it is negligible.
DrivingPlane fit_driving_plane(std::vector<Eigen::Vector3d> path_in_map, const Eigen::Vector3d& up_of_rig_in_map,
                               double up_sigma) {
  assert(!path_in_map.empty());
  DrivingPlane plane;
  plane.point_in_map = mean_of(path_in_map);
  const Eigen::Matrix3d covariance = covariance_of(path_in_map, plane.point_in_map);
  const Eigen::Vector3d squared_extents = symmetric_eigenvalues(covariance);  // ascending
  plane.thickness = root(squared_extents[0]);
  plane.width = root(squared_extents[1]);
  plane.length = root(squared_extents[2]);

  const double count = std::min(static_cast<double>(path_in_map.size()), kIndependentPositions);
  const double unevenness = std::max(plane.thickness, kFloorUnevenness * plane.length);
  plane.up_information = Eigen::Matrix3d::Identity() / (up_sigma * up_sigma);
  if (unevenness > 0.0) {
    const Eigen::Matrix3d in_plane = covariance - squared_extents[0] * Eigen::Matrix3d::Identity();
    plane.up_information += count / (unevenness * unevenness) * in_plane;
  }
  plane.up_in_map = (plane.up_information.inverse() * up_of_rig_in_map).normalized();
  plane.path_in_map = std::move(path_in_map);
  return plane;
}

DrivingPlane require_driving_plane(const MapGraph& map, const std::optional<UpInBody>& base, const std::string& name) {
  const std::optional<DrivingPlane> plane = fit_driving_plane(map, base);
  if (!plane) {
    throw InputError(name,
                     "does not determine the vertical: it has no keyframes, or they have no common upright direction",
                     "map a recording of a camera that stays upright");
  }
  return *plane;
}

Eigen::Vector3d body_at(const MapGraph& map, const Keyframe& keyframe) {
  const Pose& body_from_camera = map.rigs()[static_cast<std::size_t>(keyframe.rig)].body_from_camera;
  return (inverse(keyframe.camera_from_world) * inverse(body_from_camera)).translation;
}

std::optional<DrivingPlane> fit_driving_plane(const MapGraph& map, const std::optional<UpInBody>& base) {
  Eigen::Vector3d up = Eigen::Vector3d::Zero();
  std::vector<Eigen::Vector3d> path;
  for (const KeyframeId id : map.keyframe_ids()) {
    const Keyframe& keyframe = *map.keyframe_header(id);
    const Pose& body_from_camera = map.rigs()[static_cast<std::size_t>(keyframe.rig)].body_from_camera;
    const Eigen::Vector3d up_in_camera =
        base ? body_from_camera.rotation.conjugate() * base->up : -Eigen::Vector3d::UnitY();
    up += keyframe.camera_from_world.rotation.conjugate() * up_in_camera;
    path.push_back(body_at(map, keyframe));
  }
  if (!(up.norm() > kLeastCommonUp * map.keyframe_count())) return std::nullopt;
  return fit_driving_plane(std::move(path), up.normalized(), base ? base->sigma : kUprightSigma);
}

}  // namespace byre
