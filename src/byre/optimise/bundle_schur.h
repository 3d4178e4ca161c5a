#pragma once

#include "byre/optimise/bundle_roles.h"

#include <optional>

namespace byre {

// Levenberg and Marquardt's method over poses, points and the calibration where one is sought, with the points
// eliminated one by one (Schur complement, Triggs 2000, section 6). What Ceres keeps for each residual takes more time
// and memory than the residual. Damping and ends are those of Ceres' trust region. Precondition: roles are those of the
// problem.
BundleSolution solve_bundle(const BundleProblem& problem, const BundleRoles& roles,
                            const std::optional<HeldDistance>& scale, const BundleOptions& options);

}  // namespace byre
