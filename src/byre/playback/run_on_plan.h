#pragma once

#include "byre/map/plan_registration.h"
#include "byre/playback/map_run.h"

namespace byre {

// Poses in the map, on its floor plan. Their covariances, as seen in the body, stay as they are: relative to the map's
// origin, and without what the registration adds.
Trajectory on_plan(Trajectory trajectory, const PlanRegistration& registration);
MappedFrame on_plan(MappedFrame frame, const PlanRegistration& registration);
MapRun on_plan(MapRun run, const PlanRegistration& registration);  // all but odometry and the map itself

}  // namespace byre
