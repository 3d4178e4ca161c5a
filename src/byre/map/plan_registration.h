#pragma once

#include "byre/alignment.h"

#include <string>

namespace byre {

using Matrix7 = Eigen::Matrix<double, 7, 7>;

// Where a map lies on a floor plan. The plan's frame has x and y as the plan has them, in metres, and z up: the height
// above the floor that was driven on.
struct PlanRegistration {
  std::string plan;          // name of the plan
  Similarity plan_from_map;  // scale: metres per unit of the map, 1 for a metric one
  // Covariance of a small motion as seen in the map's frame, translation (metres) and rotation vector (radians) of
  // delta in plan_from_map * exp_pose(delta), and of the logarithm of the scale; zero for a scale that was not looked
  // for.
  Matrix7 covariance = Matrix7::Zero();
};

// A pose that is known in the map, on the plan: lengths become metres, and the rest is a rigid motion.
Pose plan_from_body(const PlanRegistration& registration, const Pose& map_from_body);

// How well that pose is known on the plan: covariance of delta in plan_from_body * exp_pose(delta), metres and radians.
// covariance: that of delta in map_from_body * exp_pose(delta), in the map's lengths. What the registration leaves open
// is added, as it has nothing to do with what a frame shows.
Matrix6 covariance_on_plan(const PlanRegistration& registration, const Pose& map_from_body, const Matrix6& covariance);

// How well it is known where a point of the map lies on the plan: covariance of x and y, square metres.
Eigen::Matrix2d plan_covariance_at(const PlanRegistration& registration, const Eigen::Vector3d& point_in_map);

// How a point's place on the plan, height included, changes with what PlanRegistration::covariance is of.
using PlanJacobian = Eigen::Matrix<double, 3, 7>;
PlanJacobian plan_jacobian(const Similarity& plan_from_map, const Eigen::Vector3d& point_in_map);

}  // namespace byre
