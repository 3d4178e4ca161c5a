#pragma once

#include <ceres/problem.h>

namespace byre {

// For problems whose costs, losses and manifolds live beside them, and which were checked before.
inline ceres::Problem::Options borrowing_problem() {
  ceres::Problem::Options options;
  options.cost_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  options.loss_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  options.manifold_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  options.disable_all_safety_checks = true;
  return options;
}

}  // namespace byre
