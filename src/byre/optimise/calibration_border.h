#pragma once

#include "byre/optimise/bundle_adjustment.h"
#include "byre/optimise/reduced_system.h"
#include "byre/optimise/trust_region.h"

#include <optional>

namespace byre {

// What a calibration sought along with poses and points adds to their normal equations: a border of as many rows as it
// has parameters, dense, for each observation has to do with it. With the points eliminated an arrow is left: sparse
// between poses, with the calibration at its edge. Filled observation by observation, point by point; of a point it
// knows what was added since begin_point, as that of all of them would take more memory than all else of the points.
class CalibrationBorder {
 public:
  // Derivatives of the residuals (u, v, disparity; in sigmas) by the change of the calibration.
  using Slope = Eigen::Matrix<double, 3, kCalibrationParameters>;
  using ByPoint = Slope;  // normal matrix between a point and the calibration

  // The problem is owned by the caller. poses: how many move.
  CalibrationBorder(const BundleProblem& problem, int poses);

  // Acts where the point is expected, not where it was measured: there the slope would share the noise of the residual,
  // and hundreds of thousands of measurements would agree on a focal length that is too long. Zero for what was seen
  // through another rig.
  Slope slope(const BundleObservation& seen, const Eigen::Vector3d& point_in_camera) const;
  // Cost of a change by what is known beforehand.
  double cost(const CalibrationVector& change) const;

  // What is known beforehand, at this change; nothing else yet.
  void begin(const CalibrationVector& change);
  void add(const Slope& slope, double weight, const Eigen::Vector3d& residual);
  void add_pose(int slot, const Eigen::Matrix<double, 6, 3>& weighted_by_pose, const Slope& slope);
  void begin_point() { with_point_.setZero(); }
  void add_point(const Eigen::Matrix3d& weighted_by_point, const Slope& slope);
  // What finding the point uses up. gain: normal matrix between a pose and the point, times the point's covariance.
  void eliminate(const Eigen::Matrix3d& covariance, const Eigen::Vector3d& gradient);
  void eliminate_pose(int slot, const Eigen::Matrix<double, 6, 3>& gain);
  void damp(double radius) { damping_ = own_.diagonal().unaryExpr(&bounded) / radius; }
  double largest_slope() const { return gradient_.cwiseAbs().maxCoeff(); }  // slope of the cost

  struct Step {
    Eigen::VectorXd poses;  // six a slot
    CalibrationVector calibration;
    double expected_gain = 0.0;  // the calibration's share of the gain, were the costs quadratic
  };
  // Solves the arrow; empty where it has no solution. pull: right-hand side of the poses.
  std::optional<Step> solve(ReducedSystem& poses, const Eigen::VectorXd& pull) const;
  // What the calibration's step asks of the point, as a slope of the cost.
  Eigen::Vector3d pull_on_point(const CalibrationVector& step) const { return with_point_ * step; }

 private:
  const BundleProblem& problem_;  // constant after construction
  const BundleCalibration& calibration_;
  CalibrationMatrix own_;  // before the points are eliminated
  CalibrationVector gradient_;
  CalibrationMatrix used_up_own_;  // parts of the two that finding the points uses up
  CalibrationVector used_up_gradient_;
  CalibrationVector damping_;                                                 // added to the diagonal of own_
  Eigen::Matrix<double, Eigen::Dynamic, kCalibrationParameters> with_poses_;  // six rows a slot
  ByPoint with_point_;
};

}  // namespace byre
