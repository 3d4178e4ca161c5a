#include "byre/playback/run_on_plan.h"

#include <utility>

namespace byre {

Trajectory on_plan(Trajectory trajectory, const PlanRegistration& registration) {
  for (StampedPose& sample : trajectory) sample.world_from_body = plan_from_body(registration, sample.world_from_body);
  return trajectory;
}

PlayedFrame on_plan(PlayedFrame frame, const PlanRegistration& registration) {
  if (!frame.report || !frame.report->map_from_body) return frame;
  FrameReport& report = *frame.report;
  report.covariance = covariance_on_plan(registration, *report.map_from_body, report.covariance);
  report.map_from_body = plan_from_body(registration, *report.map_from_body);
  return frame;
}

RunResult on_plan(RunResult run, const PlanRegistration& registration) {
  run.causal = on_plan(std::move(run.causal), registration);
  run.final = on_plan(std::move(run.final), registration);
  for (PlayedFrame& frame : run.frames) frame = on_plan(std::move(frame), registration);
  return run;
}

}  // namespace byre
