#pragma once

#include "byre/optimise/pose_graph.h"

#include <ceres/sized_cost_function.h>

namespace byre {

using Vector7 = Eigen::Matrix<double, 7, 1>;
using Matrix7 = Eigen::Matrix<double, 7, 7>;

// Error of an edge: delta in exp_pose(delta) * measured = predicted, then the logarithm of predicted over measured
// scale; whitened. For an edge in world lengths all scales count as 1. Parameter blocks, three per node: rotation
// camera_from_world as a quaternion on the RotationManifold, position of the camera in the world, logarithm of the
// scale. Positions, unlike translations, do not change when a camera far from the origin rotates.
class PoseGraphCost final : public ceres::SizedCostFunction<7, 4, 3, 1, 4, 3, 1> {
 public:
  // Without constrains_scale the scale's error is zero.
  PoseGraphCost(const PoseGraphEdge& edge, bool constrains_scale);
  bool Evaluate(const double* const* parameters, double* residual, double** jacobians) const override;

 private:
  // Constant after construction.
  Eigen::Quaterniond second_from_first_;
  Eigen::Vector3d second_in_first_;  // position, in the first camera's lengths
  double log_scale_;
  double scale_weight_;  // 1, or 0 for an edge in world lengths
  Matrix7 whitening_;
};

}  // namespace byre
