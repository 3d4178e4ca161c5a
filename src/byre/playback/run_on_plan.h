#pragma once

#include "byre/map/plan_registration.h"
#include "byre/playback/map_run.h"

namespace byre {

// Poses in the map, on its floor plan, with covariances that hold what the registration adds. How far poses may be
// relied on is judged in the map all the same: there the robot knows its way, however the map lies on the plan.
Trajectory on_plan(Trajectory trajectory, const PlanRegistration& registration);
MappedFrame on_plan(MappedFrame frame, const PlanRegistration& registration);
MapRun on_plan(MapRun run, const PlanRegistration& registration);  // all but odometry and the map itself

}  // namespace byre
