#pragma once

#include "byre/plan_registration.h"
#include "byre/playback/play.h"

namespace byre {

// Transforms poses from the map to its floor plan, and adds the covariance of the registration. Verdicts are still
// those in the map, as the registration does not affect navigation.
Trajectory on_plan(Trajectory trajectory, const PlanRegistration& registration);
PlayedFrame on_plan(PlayedFrame frame, const PlanRegistration& registration);
RunResult on_plan(RunResult run, const PlanRegistration& registration);  // without odometry and the map itself

}  // namespace byre
