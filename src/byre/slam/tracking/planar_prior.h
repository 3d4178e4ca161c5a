#pragma once

#include "byre/map/plan/driven_ground.h"
#include "byre/odometry/stationary_detector.h"
#include "byre/optimise/pose_refinement.h"

#include <optional>

namespace byre {

// Prior of a pose near the predicted one by the ground that the map was driven on: height and tilt of the body, with
// the uncertainty of the map's path. Place and heading are free. Empty far from the path, and if the prediction differs
// by more than the uncertainty explains, as on an unmapped ramp.
std::optional<PosePrior> planar_prior(const DrivenGround& ground, const Rig& rig,
                                      const Pose& predicted_camera_from_world);

// Prior of a body at standstill by measured accelerations: its tilt. Place and heading are free.
PosePrior tilt_prior(const BodyTilt& tilt, const Rig& rig, const Pose& predicted_camera_from_world);

// Combines a pose, given as a prior with its covariance, with another prior.
PosePrior combined(const PosePrior& one, const PosePrior& other);

}  // namespace byre
