#include "byre/optimise/bundle_cost.h"

#include <Eigen/Cholesky>

namespace byre {

namespace {

using RowMajor33 = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;
using RowMajor34 = Eigen::Matrix<double, 3, 4, Eigen::RowMajor>;

void write(const Eigen::Vector3d& from, double* to) {
  Eigen::Map<Eigen::Vector3d>{to} = from;
}

// The derivative by rotation and translation, from that by the point in the camera.
void write_by_pose(const Eigen::Matrix3d& by_camera, const Eigen::Vector3d& rotated_point, double** jacobians) {
  if (jacobians[0]) {
    Eigen::Map<RowMajor34> by_rotation(jacobians[0]);
    by_rotation.leftCols<3>().noalias() = -by_camera * skew(rotated_point);
    by_rotation.col(3).setZero();
  }
  if (jacobians[1]) Eigen::Map<RowMajor33>{jacobians[1]} = by_camera;
}

CalibrationVector joined(const double* const* blocks) {
  CalibrationVector change;
  for (int i = 0; i < kCalibrationBlocks; ++i) change.segment<3>(3 * i) = Eigen::Map<const Eigen::Vector3d>(blocks[i]);
  return change;
}

// The derivative by the calibration, block by block.
template <int Rows>
void write_by_calibration(const Eigen::Matrix<double, Rows, kCalibrationParameters>& slope, double** jacobians) {
  for (int i = 0; i < kCalibrationBlocks; ++i) {
    if (!jacobians[i]) continue;
    Eigen::Map<Eigen::Matrix<double, Rows, 3, Eigen::RowMajor>>{jacobians[i]} = slope.template middleCols<3>(3 * i);
  }
}

void write_by_point(const Eigen::Matrix3d& by_camera, const Eigen::Quaterniond& camera_from_world, double* jacobian) {
  if (jacobian) Eigen::Map<RowMajor33>{jacobian}.noalias() = by_camera * camera_from_world.toRotationMatrix();
}

}  // namespace

bool PoseAndPointCost::Evaluate(const double* const* parameters, double* residual, double** jacobians) const {
  const Eigen::Quaterniond rotation(parameters[0]);
  const Eigen::Vector3d rotated_point = rotation * Eigen::Vector3d(parameters[2]);
  const Eigen::Vector3d point_in_camera = rotated_point + Eigen::Vector3d(parameters[1]);
  write(reprojection_.residual(point_in_camera), residual);
  if (!jacobians) return true;
  const Eigen::Matrix3d by_camera = reprojection_.jacobian(point_in_camera);
  write_by_pose(by_camera, rotated_point, jacobians);
  write_by_point(by_camera, rotation, jacobians[2]);
  return true;
}

CalibrationCost::CalibrationCost(const Rig& rig, const CalibrationSensitivity& sensitivity,
                                 const BundleObservation& observation)
    : cost_({rig, observation.measured, observation.pixel_sigma, observation.disparity_sigma}),
      rig_(rig),
      sensitivity_(sensitivity),
      measured_(observation.measured),
      per_pixel_(1.0 / observation.pixel_sigma, 1.0 / observation.pixel_sigma,
                 observation.is_stereo() ? 1.0 / observation.disparity_sigma : 0.0) {}

Eigen::Matrix<double, 3, kCalibrationParameters> CalibrationCost::by_calibration(
    const Eigen::Vector3d& point_in_camera) const {
  StereoPixel seen = point_in_camera.z() < kNearestDepth ? measured_ : rig_.project(point_in_camera);
  if (per_pixel_.z() == 0.0) seen.z() = 0.0;
  return per_pixel_.asDiagonal() * sensitivity_.at(seen).topRows<3>();
}

bool CalibrationCost::Evaluate(const double* const* parameters, double* residual, double** jacobians) const {
  cost_.Evaluate(parameters, residual, jacobians);
  const Eigen::Vector3d rotated_point = Eigen::Quaterniond(parameters[0]) * Eigen::Vector3d(parameters[2]);
  const Eigen::Matrix<double, 3, kCalibrationParameters> slope =
      by_calibration(rotated_point + Eigen::Vector3d(parameters[1]));
  Eigen::Map<Eigen::Vector3d>{residual} += slope * joined(parameters + 3);
  if (jacobians) write_by_calibration<3>(slope, jacobians + 3);
  return true;
}

CalibrationPriorCost::CalibrationPriorCost(const CalibrationVector& expected, const CalibrationMatrix& information)
    : expected_(expected), square_root_(information.llt().matrixU()) {}

bool CalibrationPriorCost::Evaluate(const double* const* parameters, double* residual, double** jacobians) const {
  Eigen::Map<CalibrationVector>{residual} = square_root_ * (joined(parameters) - expected_);
  if (jacobians) write_by_calibration<kCalibrationParameters>(square_root_, jacobians);
  return true;
}

bool PoseCost::Evaluate(const double* const* parameters, double* residual, double** jacobians) const {
  const Eigen::Vector3d rotated_point = Eigen::Quaterniond(parameters[0]) * point_in_world_;
  const Eigen::Vector3d point_in_camera = rotated_point + Eigen::Vector3d(parameters[1]);
  write(reprojection_.residual(point_in_camera), residual);
  if (jacobians) write_by_pose(reprojection_.jacobian(point_in_camera), rotated_point, jacobians);
  return true;
}

bool DistanceCost::Evaluate(const double* const* parameters, double* residual, double** jacobians) const {
  const Eigen::Vector3d rotated_place = Eigen::Quaterniond(parameters[0]) * place_in_world_;
  const Eigen::Vector3d place_in_camera = rotated_place + Eigen::Vector3d(parameters[1]);
  *residual = (place_in_camera.norm() - distance_) / sigma_;
  if (!jacobians) return true;
  const Eigen::RowVector3d by_camera = place_in_camera.normalized().transpose() / sigma_;
  if (jacobians[0]) {
    Eigen::Map<Eigen::RowVector4d> by_rotation(jacobians[0]);
    by_rotation.head<3>() = -by_camera * skew(rotated_place);
    by_rotation.w() = 0.0;
  }
  if (jacobians[1]) Eigen::Map<Eigen::RowVector3d>{jacobians[1]} = by_camera;
  return true;
}

bool PointCost::Evaluate(const double* const* parameters, double* residual, double** jacobians) const {
  const Eigen::Vector3d point_in_camera = camera_from_world_ * Eigen::Vector3d(parameters[0]);
  write(reprojection_.residual(point_in_camera), residual);
  if (jacobians) write_by_point(reprojection_.jacobian(point_in_camera), camera_from_world_.rotation, jacobians[0]);
  return true;
}

}  // namespace byre
