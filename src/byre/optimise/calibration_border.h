#pragma once

#include "byre/optimise/bundle_adjustment.h"
#include "byre/optimise/reduced_system.h"
#include "byre/optimise/trust_region.h"

#include <optional>

namespace byre {

// Contribution of self-calibration to the normal equations of poses and points: a dense border with one row per
// parameter, as each observation depends on the calibration. With the points eliminated, the matrix is an arrow: sparse
// between poses, with the calibration at its edge. Filled point by point; terms between a point and the calibration are
// held for one point only, because those of all points would dominate the memory.
class CalibrationBorder {
 public:
  // Derivatives of the residuals (u, v, disparity; in sigmas) by the change of the calibration.
  using Jacobian = Eigen::Matrix<double, 3, kCalibrationParameters>;
  using ByPoint = Jacobian;  // normal matrix between a point and the calibration

  // The problem is owned by the caller. poses: number of moving poses.
  CalibrationBorder(const BundleProblem& problem, int poses);

  // Evaluated at the predicted pixel, not the measured one, whose noise would correlate with the residual: over
  // hundreds of thousands of measurements this biases the focal length upwards. Zero for observations by another rig.
  Jacobian jacobian(const BundleObservation& seen, const Eigen::Vector3d& point_in_camera) const;
  // Cost of a change under the prior.
  double cost(const CalibrationVector& change) const;

  // Starts the equations with the prior at this change.
  void begin(const CalibrationVector& change);
  void add(const Jacobian& jacobian, double weight, const Eigen::Vector3d& residual);
  void add_pose(int slot, const Eigen::Matrix<double, 6, 3>& weighted_by_pose, const Jacobian& jacobian);
  void begin_point() { with_point_.setZero(); }
  void add_point(const Eigen::Matrix3d& weighted_by_point, const Jacobian& jacobian);
  // Eliminate a point. gain: normal matrix between a pose and the point, times the point's covariance.
  void eliminate(const Eigen::Matrix3d& covariance, const Eigen::Vector3d& gradient);
  void eliminate_pose(int slot, const Eigen::Matrix<double, 6, 3>& gain);
  void damp(double radius) { damping_ = own_.diagonal().unaryExpr(&bounded) / radius; }
  double max_abs_gradient() const { return gradient_.cwiseAbs().maxCoeff(); }  // largest gradient component of the cost

  struct Step {
    Eigen::VectorXd poses;  // six per slot
    CalibrationVector calibration;
    double expected_gain = 0.0;  // the calibration's share of the gain under the quadratic model
  };
  // Solves the arrow system; empty if it has no solution. right_side: right-hand side of the poses.
  std::optional<Step> solve(ReducedSystem& poses, const Eigen::VectorXd& right_side) const;
  // Change of the point's gradient by the calibration's step.
  Eigen::Vector3d point_right_side(const CalibrationVector& step) const { return with_point_ * step; }

 private:
  const BundleProblem& problem_;  // constant after construction
  const BundleCalibration& calibration_;
  CalibrationMatrix own_;  // before the points are eliminated
  CalibrationVector gradient_;
  CalibrationMatrix eliminated_own_;  // parts of own_ and gradient_ removed by the elimination of the points
  CalibrationVector eliminated_gradient_;
  CalibrationVector damping_;                                                 // added to the diagonal of own_
  Eigen::Matrix<double, Eigen::Dynamic, kCalibrationParameters> with_poses_;  // six rows per slot
  ByPoint with_point_;
};

}  // namespace byre
