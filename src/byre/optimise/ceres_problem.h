#pragma once

#include <ceres/problem.h>

namespace byre {

// For problems whose costs, losses and manifolds are owned by the caller and validated before.
inline ceres::Problem::Options non_owning_problem_options() {
  ceres::Problem::Options options;
  options.cost_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  options.loss_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  options.manifold_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  options.disable_all_safety_checks = true;
  return options;
}

}  // namespace byre
