#pragma once

#include "byre/optimise/bundle_roles.h"

#include <optional>

namespace byre {

// Levenberg-Marquardt over poses, points and, if estimated, the calibration, with points eliminated one by one (Schur
// complement, Triggs 2000, section 6). Ceres' records per residual take more time and memory than the residual. Damping
// and convergence criteria are those of Ceres' trust region. Precondition: roles are those of the problem.
BundleSolution solve_bundle(const BundleProblem& problem, const BundleRoles& roles,
                            const std::optional<FixedDistance>& scale, const BundleOptions& options);

}  // namespace byre
