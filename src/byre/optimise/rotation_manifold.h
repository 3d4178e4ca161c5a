#pragma once

#include <ceres/problem.h>
#include <ceres/version.h>

#if CERES_VERSION_MAJOR == 2 && CERES_VERSION_MINOR == 0
#include <ceres/local_parameterization.h>
#else
#include <ceres/manifold.h>
#endif

namespace byre {

#if CERES_VERSION_MAJOR == 2 && CERES_VERSION_MINOR == 0

// Manifold of Ceres 2.1, as a local parameterization of Ceres 2.0.
class CeresManifold : public ceres::LocalParameterization {
 public:
  virtual int AmbientSize() const = 0;
  virtual int TangentSize() const = 0;
  virtual bool PlusJacobian(const double* x, double* jacobian) const = 0;
  virtual bool Minus(const double* y, const double* x, double* y_minus_x) const = 0;
  virtual bool MinusJacobian(const double* x, double* jacobian) const = 0;

  int GlobalSize() const final { return AmbientSize(); }
  int LocalSize() const final { return TangentSize(); }
  bool ComputeJacobian(const double* x, double* jacobian) const final { return PlusJacobian(x, jacobian); }
};

inline void set_manifold(ceres::Problem& problem, double* block, CeresManifold& manifold) {
  problem.SetParameterization(block, &manifold);
}

inline void keep_manifolds(ceres::Problem::Options& options) {
  options.local_parameterization_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
}

#else

using CeresManifold = ceres::Manifold;

inline void set_manifold(ceres::Problem& problem, double* block, CeresManifold& manifold) {
  problem.SetManifold(block, &manifold);
}

inline void keep_manifolds(ceres::Problem::Options& options) {
  options.manifold_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
}

#endif

// Unit quaternion (x, y, z, w) updated as rotation_exp(delta) * rotation. Costs write their derivatives by delta to the
// first three of four columns, and PlusJacobian is the identity above a zero row, which avoids the quaternion's chain
// rule.
class RotationManifold final : public CeresManifold {
 public:
  int AmbientSize() const override { return 4; }
  int TangentSize() const override { return 3; }
  bool Plus(const double* x, const double* delta, double* x_plus_delta) const override;
  bool PlusJacobian(const double* x, double* jacobian) const override;
  bool Minus(const double* y, const double* x, double* y_minus_x) const override;
  bool MinusJacobian(const double* x, double* jacobian) const override;
};

}  // namespace byre
