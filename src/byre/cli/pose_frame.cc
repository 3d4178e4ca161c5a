#include "byre/cli/pose_frame.h"

#include "byre/input_error.h"

#include <map>
#include <string>

#include <CLI/CLI.hpp>

namespace byre::cli {

CLI::Option* declare_pose_frame(CLI::App& command, PoseFrame& frame) {
  const std::map<std::string, PoseFrame> frames = {{"map", PoseFrame::map}, {"plan", PoseFrame::plan}};
  return command.add_option("--frame", frame, "Frame of the poses: the map's, or that of the plan it lies on (map)")
      ->type_name("map|plan")
      ->transform(CLI::CheckedTransformer(frames).description(""));
}

const PlanRegistration& require_plan(const std::optional<PlanRegistration>& plan, const std::filesystem::path& map) {
  if (plan) return *plan;
  throw InputError(map.string(), "lies on no floor plan, so poses cannot be given on one", "see \"byre register\"");
}

Trajectory on_plan(Trajectory trajectory, const PlanRegistration& registration) {
  for (StampedPose& sample : trajectory) sample.world_from_body = plan_from_body(registration, sample.world_from_body);
  return trajectory;
}

MappedFrame on_plan(MappedFrame frame, const PlanRegistration& registration) {
  if (!frame.report || !frame.report->map_from_body) return frame;
  frame.report->map_from_body = plan_from_body(registration, *frame.report->map_from_body);
  return frame;
}

MapRun on_plan(MapRun run, const PlanRegistration& registration) {
  run.causal = on_plan(std::move(run.causal), registration);
  run.final = on_plan(std::move(run.final), registration);
  for (MappedFrame& frame : run.frames) frame = on_plan(std::move(frame), registration);
  return run;
}

}  // namespace byre::cli
