#include "byre/plan_registration.h"

namespace byre {

Pose plan_from_body(const PlanRegistration& registration, const Pose& map_from_body) {
  const auto& [scale, plan_from_map] = registration.plan_from_map;
  return plan_from_map * scale_lengths(map_from_body, scale);
}

Matrix6 covariance_on_plan(const PlanRegistration& registration, const Pose& map_from_body, const Matrix6& covariance) {
  const double scale = registration.plan_from_map.scale;
  const Pose body_from_map = inverse(scale_lengths(map_from_body, scale));
  Eigen::Matrix<double, 6, 7> of_registration;
  of_registration << adjoint(body_from_map), Vector6::Zero();
  of_registration.topRightCorner<3, 1>() = -body_from_map.translation;  // the scale moves the body from the origin
  return scale_lengths(covariance, scale) + of_registration * registration.covariance * of_registration.transpose();
}

PlanJacobian plan_jacobian(const Similarity& plan_from_map, const Eigen::Vector3d& point_in_map) {
  const Eigen::Matrix3d rotation = plan_from_map.target_from_source.rotation.toRotationMatrix();
  const Eigen::Vector3d scaled = plan_from_map.scale * point_in_map;
  PlanJacobian jacobian;
  jacobian << rotation, -rotation * skew(scaled), rotation * scaled;
  return jacobian;
}

Eigen::Matrix2d plan_covariance_at(const PlanRegistration& registration, const Eigen::Vector3d& point_in_map) {
  const Eigen::Matrix<double, 2, 7> jacobian = plan_jacobian(registration.plan_from_map, point_in_map).topRows<2>();
  return jacobian * registration.covariance * jacobian.transpose();
}

}  // namespace byre
