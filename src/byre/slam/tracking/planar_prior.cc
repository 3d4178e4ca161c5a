#include "byre/slam/tracking/planar_prior.h"

#include "byre/geometry/decompositions.h"
#include "byre/slam/tracking/body_pose.h"

#include <cmath>

#include <Eigen/Cholesky>

namespace byre {
namespace {

constexpr double kOpenMetres = 10.0;      // metres, sigma of a free position
constexpr double kOpenRadians = 3.0;      // radians, sigma of a free heading
constexpr double kLeastVariance = 1e-12;  // square metres and square radians

// Covariance with one sigma along a direction and another across it.
Eigen::Matrix3d covariance_about(const Eigen::Vector3d& direction, double along, double across) {
  const Eigen::Matrix3d projector = direction * direction.transpose();
  return along * along * projector + across * across * (Eigen::Matrix3d::Identity() - projector);
}

bool is_explained(const DrivenGround::GroundOffset& offset) {
  constexpr double kFar = 3.0;  // metres, from the path
  constexpr double kSigmas = 4.0;
  return offset.distance <= kFar && std::abs(offset.height) <= kSigmas * offset.height_sigma &&
         offset.tilt <= kSigmas * offset.tilt_sigma;
}

}  // namespace

std::optional<PosePrior> planar_prior(const DrivenGround& ground, const Rig& rig,
                                      const Pose& predicted_camera_from_world) {
  const Pose body = body_pose(rig, predicted_camera_from_world);
  const DrivenGround::GroundOffset offset = ground.offset_from_ground(body);
  if (!is_explained(offset)) return std::nullopt;
  const Eigen::Vector3d& up = ground.up_in_body();
  const Pose placed{(body.rotation * rotation_between(up, offset.up_in_body)).normalized(),
                    body.translation - offset.height * offset.up_in_map};
  Matrix6 covariance = Matrix6::Zero();
  covariance.topLeftCorner<3, 3>() = covariance_about(up, offset.height_sigma, kOpenMetres);
  covariance.bottomRightCorner<3, 3>() = covariance_about(up, kOpenRadians, offset.tilt_sigma);
  return PosePrior{camera_pose(rig, placed), move_covariance(covariance, inverse(rig.body_from_camera))};
}

PosePrior tilt_prior(const BodyTilt& tilt, const Rig& rig, const Pose& predicted_camera_from_world) {
  const Pose body = body_pose(rig, predicted_camera_from_world);
  const Eigen::Vector3d predicted_up = body.rotation.conjugate() * tilt.up_in_map;
  const Pose tilted{(body.rotation * rotation_between(tilt.up_in_body, predicted_up)).normalized(), body.translation};
  Matrix6 covariance = kOpenMetres * kOpenMetres * Matrix6::Identity();
  covariance.bottomRightCorner<3, 3>() = covariance_about(tilt.up_in_body, kOpenRadians, tilt.sigma);
  return {camera_pose(rig, tilted), move_covariance(covariance, inverse(rig.body_from_camera))};
}

PosePrior combined(const PosePrior& one, const PosePrior& other) {
  const auto information = [](const Matrix6& covariance) -> Matrix6 {
    return (covariance + kLeastVariance * Matrix6::Identity()).ldlt().solve(Matrix6::Identity());
  };
  const Matrix6 of_other = information(other.covariance);
  const Matrix6 covariance = (information(one.covariance) + of_other).ldlt().solve(Matrix6::Identity());
  const Vector6 apart = log_pose(other.camera_from_world * inverse(one.camera_from_world));
  return {exp_pose(covariance * (of_other * apart)) * one.camera_from_world, covariance};
}

}  // namespace byre
