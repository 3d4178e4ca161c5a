#include "byre/optimise/pose_graph_cost.h"

#include "byre/optimise/rotation_jacobian.h"

#include <cmath>

#include <Eigen/Cholesky>

namespace byre {

namespace {

// Derivatives of an edge's error by a node's rotation, position and logarithm of the scale.
using NodeJacobian = Matrix7;

// A node from Ceres' parameter blocks.
struct NodeState {
  explicit NodeState(const double* const* parameters)
      : rotation(parameters[0]), position_in_world(parameters[1]), log_scale(*parameters[2]) {}

  Eigen::Quaterniond rotation;  // camera_from_world
  Eigen::Vector3d position_in_world;
  double log_scale;
};

// A root W of the information, W^T W = information. Also for singular matrices.
Matrix6 square_root(const Matrix6& information) {
  const Eigen::LDLT<Matrix6> factor(information);
  const Vector6 diagonal = factor.vectorD().cwiseMax(0.0).cwiseSqrt();
  const Matrix6 permutation = factor.transpositionsP() * Matrix6::Identity();
  return diagonal.asDiagonal() * (factor.matrixU() * permutation);
}

Matrix7 whitening_of(const PoseGraphEdge& edge, bool constrains_scale) {
  Matrix7 whitening = Matrix7::Zero();
  whitening.topLeftCorner<6, 6>() = square_root(edge.information);
  if (constrains_scale && !edge.is_in_world_lengths) whitening(6, 6) = 1.0 / edge.scale_sigma;
  return whitening;
}

// Writes the requested derivatives by one node's blocks, row-major as in Ceres.
void write(const NodeJacobian& jacobian, double** blocks) {
  if (blocks[0]) {
    Eigen::Map<Eigen::Matrix<double, 7, 4, Eigen::RowMajor>> by_rotation(blocks[0]);
    by_rotation << jacobian.leftCols<3>(), Vector7::Zero();
  }
  if (blocks[1]) Eigen::Map<Eigen::Matrix<double, 7, 3, Eigen::RowMajor>>{blocks[1]} = jacobian.middleCols<3>(3);
  if (blocks[2]) Eigen::Map<Vector7>{blocks[2]} = jacobian.col(6);
}

}  // namespace

PoseGraphCost::PoseGraphCost(const PoseGraphEdge& edge, bool constrains_scale)
    : second_from_first_(edge.second_from_first.rotation),
      second_in_first_(inverse(edge.second_from_first).translation / (edge.is_in_world_lengths ? 1.0 : edge.scale)),
      log_scale_(std::log(edge.scale)),
      scale_weight_(edge.is_in_world_lengths ? 0.0 : 1.0),
      whitening_(whitening_of(edge, constrains_scale)) {}

// Error for rotations R, positions c, scales s = exp(l) and the measured position m of the second camera in the first:
//   s2 R2 (c1 - c2) + s2/s1 R2 R1^T m,   log(R2 R1^T measured^T),   l2 - l1 - measured.
bool PoseGraphCost::Evaluate(const double* const* parameters, double* residual, double** jacobians) const {
  const NodeState first(parameters);
  const NodeState second(parameters + 3);
  const double first_scale = scale_weight_ * first.log_scale, second_scale = scale_weight_ * second.log_scale;
  const Eigen::Matrix3d scaled_rotation = std::exp(second_scale) * second.rotation.toRotationMatrix();
  const Eigen::Quaterniond second_from_first = second.rotation * first.rotation.conjugate();
  const Eigen::Matrix3d rotation = second_from_first.toRotationMatrix();
  const double scale = std::exp(second_scale - first_scale);
  const Eigen::Vector3d measured_arm = scale * (rotation * second_in_first_);

  const Eigen::Vector3d between = first.position_in_world - second.position_in_world;
  Vector7 error;
  error.head<3>() = scaled_rotation * between + measured_arm;
  error.segment<3>(3) = rotation_log(second_from_first * second_from_first_.conjugate());
  error[6] = second.log_scale - first.log_scale - log_scale_;
  Eigen::Map<Vector7>{residual} = whitening_ * error;
  if (!jacobians) return true;

  const Eigen::Matrix3d turn_by_second = inverse_left_jacobian(error.segment<3>(3));
  NodeJacobian by_first = NodeJacobian::Zero();
  by_first.block<3, 3>(0, 0) = scale * rotation * skew(second_in_first_);
  by_first.block<3, 3>(0, 3) = scaled_rotation;
  by_first.block<3, 1>(0, 6) = -scale_weight_ * measured_arm;
  by_first.block<3, 3>(3, 0) = -turn_by_second * rotation;
  by_first(6, 6) = -1.0;
  NodeJacobian by_second = NodeJacobian::Zero();
  by_second.block<3, 3>(0, 0) = -skew(error.head<3>());
  by_second.block<3, 3>(0, 3) = -scaled_rotation;
  by_second.block<3, 1>(0, 6) = scale_weight_ * error.head<3>();
  by_second.block<3, 3>(3, 0) = turn_by_second;
  by_second(6, 6) = 1.0;
  write(whitening_ * by_first, jacobians);
  write(whitening_ * by_second, jacobians + 3);
  return true;
}

}  // namespace byre
