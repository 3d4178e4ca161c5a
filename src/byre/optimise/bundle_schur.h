#pragma once

#include "byre/optimise/bundle_roles.h"

#include <optional>

namespace byre {

// Moving poses up to which solve_bundle_densely is meant to be used: its time grows with their cube.
inline constexpr int kMaxDensePoses = 60;

// Levenberg and Marquardt's method over poses and points, with the points eliminated one by one (Schur complement,
// Triggs 2000, section 6). For windows: what Ceres keeps for each residual costs more than the residual. Damping and
// ends are those of Ceres' trust region. Preconditions: no calibration is sought; roles are those of the problem.
BundleSolution solve_bundle_densely(const BundleProblem& problem, const BundleRoles& roles,
                                    const std::optional<HeldDistance>& scale, const BundleOptions& options);

}  // namespace byre
