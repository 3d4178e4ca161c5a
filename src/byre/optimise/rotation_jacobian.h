#pragma once

#include "byre/pose.h"

#include <cmath>

namespace byre {

// d(rotation_log(rotation_exp(delta) * rotation)) / d(delta), from rotation_log(rotation) (Chirikjian 2012, eq. 10.86).
inline Eigen::Matrix3d inverse_left_jacobian(const Eigen::Vector3d& logarithm) {
  const double angle = logarithm.norm();
  const double half = 0.5 * angle;
  const double factor = angle < 1e-3 ? 1.0 / 12.0 : (1.0 - half / std::tan(half)) / (angle * angle);
  const Eigen::Matrix3d cross = skew(logarithm);
  return Eigen::Matrix3d::Identity() - 0.5 * cross + factor * cross * cross;
}

}  // namespace byre
