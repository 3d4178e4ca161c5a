#pragma once

#include <ceres/manifold.h>

namespace byre {

// A rotation as a unit quaternion (x, y, z, w) moves as rotation_exp(delta) * rotation. Costs give their derivatives by
// delta in the first three of four columns, and the Jacobian of Plus is the identity above a row of zeros: the chain
// through the quaternion would only be multiplied in and out again.
class RotationManifold final : public ceres::Manifold {
 public:
  int AmbientSize() const override { return 4; }
  int TangentSize() const override { return 3; }
  bool Plus(const double* x, const double* delta, double* x_plus_delta) const override;
  bool PlusJacobian(const double* x, double* jacobian) const override;
  bool Minus(const double* y, const double* x, double* y_minus_x) const override;
  bool MinusJacobian(const double* x, double* jacobian) const override;
};

}  // namespace byre
