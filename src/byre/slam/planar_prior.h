#pragma once

#include "byre/map/driven_ground.h"
#include "byre/motion/standing.h"
#include "byre/optimise/pose_refinement.h"

#include <optional>

namespace byre {

// What the ground that the map was driven on says of a pose near the predicted one: how high the body stands on it, and
// how tilted, as well as the path of the map tells. Place and heading stay open. Empty far from the path, and where the
// prediction itself stands otherwise than that explains, as on a ramp that the map does not know.
std::optional<PosePrior> planar_prior(const DrivenGround& ground, const Rig& rig,
                                      const Pose& predicted_camera_from_world);

// What accelerations say of the pose of a body that stands still: how it is tilted. Place and heading stay open.
PosePrior tilt_prior(const BodyTilt& tilt, const Rig& rig, const Pose& predicted_camera_from_world);

// A pose with its covariance and what else is known of it, taken together: of a prior's form.
PosePrior combined(const PosePrior& one, const PosePrior& other);

}  // namespace byre
