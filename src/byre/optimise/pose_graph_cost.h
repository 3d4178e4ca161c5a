#pragma once

#include "byre/optimise/pose_graph.h"

#include <ceres/sized_cost_function.h>

namespace byre {

using Vector7 = Eigen::Matrix<double, 7, 1>;
using Matrix7 = Eigen::Matrix<double, 7, 7>;

// The error of an edge: delta in exp_pose(delta) * measured = predicted, then the logarithm of the predicted by the
// measured scale; whitened. For an edge in the world's lengths all scales count as 1. Of each node, first and second,
// Ceres gets three blocks: the rotation camera_from_world as a quaternion on the RotationManifold, the camera's
// position in the world, and the logarithm of the scale. Positions, unlike translations, do not swing about a far
// origin when the camera turns.
class PoseGraphCost final : public ceres::SizedCostFunction<7, 4, 3, 1, 4, 3, 1> {
 public:
  // The scale's error is zero unless it has a say.
  PoseGraphCost(const PoseGraphEdge& edge, bool scale_has_a_say);
  bool Evaluate(const double* const* parameters, double* residual, double** jacobians) const override;

 private:
  // Constant after construction.
  Eigen::Quaterniond second_from_first_;
  Eigen::Vector3d second_in_first_;  // position, in lengths of the first
  double log_scale_;
  double scales_have_a_part_;  // 1, or 0 for an edge in the world's lengths
  Matrix7 whitening_;
};

}  // namespace byre
