#pragma once

#include <ceres/manifold.h>

namespace byre {

// Unit quaternion (x, y, z, w) updated as rotation_exp(delta) * rotation. Costs write their derivatives by delta to the
// first three of four columns, and PlusJacobian is the identity above a zero row, which avoids the quaternion's chain
// rule.
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
