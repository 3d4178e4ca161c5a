#pragma once

#include "byre/geometry/pose.h"
#include "byre/optimise/reprojection.h"

#include <ceres/manifold.h>
#include <ceres/sized_cost_function.h>

namespace byre {

// Costs between camera_from_world, which Ceres gets as two blocks (rotation as quaternion x, y, z, w; translation),
// and point_in_world. All residuals have three rows and all blocks three degrees of freedom, because for these sizes
// Ceres has a Schur complement compiled for the purpose; a monocular row of zeros costs less than a general one.

// A rotation moves as rotation_exp(delta) * rotation. The costs below give their derivatives by delta in the first
// three of four columns, and the Jacobian of Plus is the identity above a row of zeros: the chain through the
// quaternion would only be multiplied in and out again.
class RotationManifold final : public ceres::Manifold {
 public:
  int AmbientSize() const override { return 4; }
  int TangentSize() const override { return 3; }
  bool Plus(const double* x, const double* delta, double* x_plus_delta) const override;
  bool PlusJacobian(const double* x, double* jacobian) const override;
  bool Minus(const double* y, const double* x, double* y_minus_x) const override;
  bool MinusJacobian(const double* x, double* jacobian) const override;
};

// Both the pose and the point move. Parameters: rotation, translation, point.
class PoseAndPointCost final : public ceres::SizedCostFunction<3, 4, 3, 3> {
 public:
  explicit PoseAndPointCost(const Reprojection& reprojection) : reprojection_(reprojection) {}
  bool Evaluate(const double* const* parameters, double* residual, double** jacobians) const override;

 private:
  Reprojection reprojection_;  // constant after construction
};

// The pose moves, the point is trusted. Parameters: rotation, translation.
class PoseCost final : public ceres::SizedCostFunction<3, 4, 3> {
 public:
  PoseCost(const Reprojection& reprojection, const Eigen::Vector3d& point_in_world)
      : reprojection_(reprojection), point_in_world_(point_in_world) {}
  bool Evaluate(const double* const* parameters, double* residual, double** jacobians) const override;

 private:
  Reprojection reprojection_;       // constant after construction
  Eigen::Vector3d point_in_world_;  // constant after construction
};

// The point moves, the pose is an anchor. Parameter: point.
class PointCost final : public ceres::SizedCostFunction<3, 3> {
 public:
  PointCost(const Reprojection& reprojection, const Pose& camera_from_world)
      : reprojection_(reprojection), camera_from_world_(camera_from_world) {}
  bool Evaluate(const double* const* parameters, double* residual, double** jacobians) const override;

 private:
  Reprojection reprojection_;  // constant after construction
  Pose camera_from_world_;     // constant after construction
};

}  // namespace byre
