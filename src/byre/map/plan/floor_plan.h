#pragma once

#include "byre/map/plan/driving_plane.h"
#include "byre/plan_registration.h"

#include <optional>
#include <span>

namespace byre {

// Registers a map on a plan: position and heading from correspondences seen from above, height and tilt from the
// driving plane, and the scale if it is free. Outliers are removed by find_planar_consensus. The inliers are fitted by
// weighted least squares, with the plane weighted by its own uncertainty. The covariance is scaled by the residuals.
// Empty with fewer than two separate correspondences.
std::optional<PlanFit> register_on_plan(std::span<const PlanCorrespondence> correspondences, const DrivingPlane& plane,
                                        Scale scale, const PlanRegistrationOptions& options = {});

// The same from an initial estimate, near which correspondences may have repeated errors. Precondition: there are any.
PlanFit register_from(const Similarity& start, std::span<const PlanCorrespondence> correspondences,
                      const DrivingPlane& plane, Scale scale, const PlanRegistrationOptions& options = {});

}  // namespace byre
