#include "byre/body_motion.h"

#include "byre/geometry/decompositions.h"

#include <cmath>

namespace byre {
namespace {

Matrix6 covariance_of_wheels(const Pose& motion) {
  constexpr double kShare = 0.02;           // standard deviation, as a share of path length and turn
  constexpr double kTurnPerMetre = 0.0175;  // radians
  constexpr double kLeast = 1e-4;           // metres and radians
  const double way = motion.translation.norm();
  const double turn = rotation_log(motion.rotation).norm();
  Matrix6 covariance = Matrix6::Zero();
  covariance.diagonal().head<3>().setConstant(std::pow(kShare * way + kLeast, 2));
  covariance.diagonal().tail<3>().setConstant(std::pow(kShare * turn + kTurnPerMetre * way + kLeast, 2));
  return covariance;
}

// Symmetric square root.
Matrix6 deviation_of(const Matrix6& covariance) {
  const auto [values, vectors] = symmetric_eigen(covariance);
  return vectors * values.cwiseMax(0.0).cwiseSqrt().asDiagonal() * vectors.transpose();
}

}  // namespace

BodyMotion::BodyMotion(const Pose& earlier_from_later)
    : BodyMotion(earlier_from_later, covariance_of_wheels(earlier_from_later)) {}

// To first order delta = adjoint(second^-1) * delta of the first + delta of the second, both of the same unit vector.
BodyMotion operator*(const BodyMotion& first, const BodyMotion& second) {
  const Matrix6 deviation =
      adjoint(inverse(second.last_from_body)) * deviation_of(first.covariance) + deviation_of(second.covariance);
  return {first.last_from_body * second.last_from_body, deviation * deviation.transpose()};
}

}  // namespace byre
