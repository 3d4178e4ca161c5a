#include "byre/optimise/calibration_border.h"

#include "byre/optimise/reprojection.h"

#include <Eigen/Cholesky>

namespace byre {

CalibrationBorder::CalibrationBorder(const BundleProblem& problem, int poses)
    : problem_(problem), calibration_(*problem.calibration), with_poses_(6 * poses, kCalibrationParameters) {}

CalibrationBorder::Jacobian CalibrationBorder::jacobian(const BundleObservation& seen,
                                                        const Eigen::Vector3d& point_in_camera) const {
  const int rig = problem_.poses[static_cast<std::size_t>(seen.pose)].rig;
  if (rig != calibration_.rig) return Jacobian::Zero();
  StereoPixel pixel = point_in_camera.z() < kNearestDepth
                          ? seen.measured
                          : problem_.rigs[static_cast<std::size_t>(rig)].project(point_in_camera);
  const double per_pixel = 1.0 / seen.pixel_sigma;
  Eigen::Vector3d scale(per_pixel, per_pixel, 0.0);
  if (seen.is_stereo()) {
    scale.z() = 1.0 / seen.disparity_sigma;
  } else {
    pixel.z() = 0.0;
  }
  return scale.asDiagonal() * calibration_.sensitivity->at(pixel).topRows<3>();
}

double CalibrationBorder::cost(const CalibrationVector& change) const {
  const CalibrationVector error = change - calibration_.expected;
  return 0.5 * error.dot(calibration_.information * error);
}

void CalibrationBorder::begin(const CalibrationVector& change) {
  own_ = calibration_.information;
  gradient_ = calibration_.information * (change - calibration_.expected);
  eliminated_own_.setZero();
  eliminated_gradient_.setZero();
  with_poses_.setZero();
}

void CalibrationBorder::add(const Jacobian& jacobian, double weight, const Eigen::Vector3d& residual) {
  own_.noalias() += weight * jacobian.transpose() * jacobian;
  gradient_.noalias() += weight * jacobian.transpose() * residual;
}

void CalibrationBorder::add_pose(int slot, const Eigen::Matrix<double, 6, 3>& weighted_by_pose,
                                 const Jacobian& jacobian) {
  with_poses_.middleRows<6>(6 * slot).noalias() += weighted_by_pose * jacobian;
}

void CalibrationBorder::add_point(const Eigen::Matrix3d& weighted_by_point, const Jacobian& jacobian) {
  with_point_.noalias() += weighted_by_point * jacobian;
}

void CalibrationBorder::eliminate(const Eigen::Matrix3d& covariance, const Eigen::Vector3d& gradient) {
  const ByPoint gain = covariance * with_point_;
  eliminated_own_.noalias() += with_point_.transpose() * gain;
  eliminated_gradient_.noalias() += gain.transpose() * gradient;
}

void CalibrationBorder::eliminate_pose(int slot, const Eigen::Matrix<double, 6, 3>& gain) {
  with_poses_.middleRows<6>(6 * slot).noalias() -= gain * with_point_;
}

std::optional<CalibrationBorder::Step> CalibrationBorder::solve(ReducedSystem& poses,
                                                                const Eigen::VectorXd& right_side) const {
  Eigen::MatrixXd sides(with_poses_.rows(), kCalibrationParameters + 1);
  sides << with_poses_, right_side;
  const std::optional<Eigen::MatrixXd> solved = poses.solve_several(sides);
  if (!solved) return std::nullopt;
  const auto by_calibration = solved->leftCols<kCalibrationParameters>();
  CalibrationMatrix reduced = own_ - eliminated_own_ - with_poses_.transpose() * by_calibration;
  reduced.diagonal() += damping_;
  const Eigen::LLT<CalibrationMatrix> factor(reduced);
  if (factor.info() != Eigen::Success) return std::nullopt;
  Step step;
  step.calibration =
      factor.solve(eliminated_gradient_ - gradient_ - with_poses_.transpose() * solved->col(kCalibrationParameters));
  if (!step.calibration.allFinite()) return std::nullopt;
  step.poses = solved->col(kCalibrationParameters) - by_calibration * step.calibration;
  step.expected_gain = 0.5 * step.calibration.dot(damping_.cwiseProduct(step.calibration) - gradient_);
  return step;
}

}  // namespace byre
