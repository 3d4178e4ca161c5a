#pragma once

#include "byre/alignment.h"

#include <string>

namespace byre {

using Matrix7 = Eigen::Matrix<double, 7, 7>;

// Registration of a map on a floor plan. Plan frame: x and y as on the plan, z up from the driven floor; metres.
struct PlanRegistration {
  std::string plan;          // name of the plan
  Similarity plan_from_map;  // scale: metres per unit of the map, 1 for a metric one
  // Covariance of delta in plan_from_map * exp_pose(delta), translation (metres) and rotation vector (radians) in the
  // map frame, and of the logarithm of the scale; zero for a fixed scale.
  Matrix7 covariance = Matrix7::Zero();
};

// The pose on the plan: lengths become metres, and the rest is a rigid motion.
Pose plan_from_body(const PlanRegistration& registration, const Pose& map_from_body);

// Covariance of delta in plan_from_body * exp_pose(delta), metres and radians. covariance: of delta in map_from_body *
// exp_pose(delta), in the map's lengths. The covariance of the registration is added as independent.
Matrix6 covariance_on_plan(const PlanRegistration& registration, const Pose& map_from_body, const Matrix6& covariance);

// Covariance of a map point's x and y on the plan, square metres.
Eigen::Matrix2d plan_covariance_at(const PlanRegistration& registration, const Eigen::Vector3d& point_in_map);

// Derivatives of a point's position on the plan, height included, by the parameters of PlanRegistration::covariance.
using PlanJacobian = Eigen::Matrix<double, 3, 7>;
PlanJacobian plan_jacobian(const Similarity& plan_from_map, const Eigen::Vector3d& point_in_map);

}  // namespace byre
