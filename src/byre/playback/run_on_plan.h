#pragma once

#include "byre/map/plan_registration.h"
#include "byre/playback/map_run.h"

namespace byre {

// Transforms poses from the map to its floor plan, and adds the covariance of the registration. Verdicts are still
// those in the map, as the registration does not affect navigation.
Trajectory on_plan(Trajectory trajectory, const PlanRegistration& registration);
MappedFrame on_plan(MappedFrame frame, const PlanRegistration& registration);
MapRun on_plan(MapRun run, const PlanRegistration& registration);  // without odometry and the map itself

}  // namespace byre
