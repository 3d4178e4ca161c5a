#include "byre/viewer/ground.h"

#include "byre/geometry/decompositions.h"
#include "byre/map/plan/driving_plane.h"
#include "byre/map/stored_calibration.h"

#include <cassert>

namespace byre {
namespace {

// Largest roughness of the path relative to its length. Above, the robot was flown or carried, and heights have no
// meaning.
constexpr double kRoughest = 0.1;

// Unit vector in the plane along the largest extent of the path, in driving direction.
Eigen::Vector3d direction_of(const DrivingPlane& plane) {
  Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
  const Eigen::Matrix3d onto_plane = Eigen::Matrix3d::Identity() - plane.up_in_map * plane.up_in_map.transpose();
  for (const Eigen::Vector3d& position : plane.path_in_map) {
    const Eigen::Vector3d offset = onto_plane * (position - plane.point_in_map);
    spread += offset * offset.transpose();
  }
  const auto [values, vectors] = symmetric_eigen(spread);
  const bool has_length = values[2] > 1e-12;
  const Eigen::Vector3d along = has_length ? vectors.col(2).eval() : plane.up_in_map.unitOrthogonal();
  const Eigen::Vector3d gone = plane.path_in_map.back() - plane.path_in_map.front();
  return along.dot(gone) < 0.0 ? (-along).eval() : along;
}

// Plane fitted to the positions; up is the world's z if the cameras do not determine it.
DrivingPlane plane_of_places(const MapGraph& map) {
  std::vector<Eigen::Vector3d> path;
  for (const KeyframeId id : map.keyframe_ids()) path.push_back(body_at(map, *map.find_keyframe(id)));
  return fit_driving_plane(std::move(path), Eigen::Vector3d::UnitZ());
}

Similarity ground_from(const DrivingPlane& plane) {
  Eigen::Matrix3d rotation;
  rotation.row(2) = plane.up_in_map;
  rotation.row(0) = direction_of(plane);
  rotation.row(1) = plane.up_in_map.cross(rotation.row(0).transpose());
  const Eigen::Quaterniond ground_from_map(rotation);
  return {1.0, {ground_from_map, -(ground_from_map * plane.point_in_map)}};
}

}  // namespace

Ground ground_of(const StoredMap& stored, const std::optional<FloorPlan>& plan) {
  assert(stored.map.keyframe_count() > 0 && (!plan || stored.plan));
  const std::optional<DrivingPlane> driven = fit_driving_plane(stored.map, up_of_base(stored));
  const DrivingPlane plane = driven ? *driven : plane_of_places(stored.map);
  Ground ground;
  ground.is_level = driven && plane.thickness <= kRoughest * plane.length;
  ground.ground_from_map = stored.plan ? stored.plan->plan_from_map : ground_from(plane);
  ground.is_metric = stored.plan || stored.scale == MapScale::metric;
  ground.plan = plan;
  if (plan) ground.image = std::make_shared<const Image>(read_plan_pixels(*plan).image);
  return ground;
}

}  // namespace byre
