#pragma once

#include "byre/optimise/bundle_adjustment.h"

#include <optional>

#include <Eigen/Cholesky>

namespace byre {

// Fixes the scale of a bundle in which nothing else determines it: the distance of a pose's camera from a given place.
struct FixedDistance {
  int pose = -1;  // index into BundleProblem::poses
  Eigen::Vector3d place_in_world = Eigen::Vector3d::Zero();
  double distance = 0.0;  // metres

  double sigma() const { return 1e-4 * distance; }  // metres
};

// The problem with sigmas at which the observations of a pose in an image region together weigh as much as with an
// error that they share, of this sigma (pixels): it does not average out over points, see PoseRefinementOptions.
BundleProblem with_shared_errors(BundleProblem problem, double systematic_sigma);

// Covariance of delta in exp_pose(delta) * camera_from_world of one pose, marginalised over all other moving poses and
// points: inverse of the robustly weighted normal matrix, by Schur complement over points, then poses. Empty if the
// observations do not determine the pose. Dense over the moving poses: cubic in their number, intended for windows.
std::optional<Matrix6> marginal_covariance(const BundleProblem& solved, const std::optional<FixedDistance>& scale,
                                           int pose, double huber_width);

// Derivatives of the weighted residual of an observation by small motions of its pose and by its point.
struct WeightedDerivatives {
  double weight = 1.0;  // robust weight of the residual in sigmas
  Eigen::Matrix<double, 3, 6> by_pose;
  Eigen::Matrix3d by_point;
};
WeightedDerivatives weighted_derivatives(const BundleProblem& solved, const BundleObservation& observation,
                                         double huber_width);

// False if the elimination nearly cancels a pivot.
template <typename Matrix>
bool is_regular(const Eigen::LLT<Matrix>& factor, const Matrix& matrix) {
  constexpr double kSingular = 1e-10;
  return factor.info() == Eigen::Success &&
         (factor.matrixLLT().diagonal().array().square() > kSingular * matrix.diagonal().array()).all();
}

// Indices of the observations in front of their cameras, grouped by point.
std::vector<int> observations_by_point(const BundleProblem& solved);

}  // namespace byre
