#include "byre/cli/shared/pose_options.h"

#include "byre/cli/shared/choice.h"
#include "byre/input_error.h"

#include <map>
#include <string>

#include <CLI/CLI.hpp>

namespace byre::cli {

CLI::Option* declare_pose_frame(CLI::App& command, PoseFrame& frame) {
  const std::map<std::string, PoseFrame> frames = {{"map", PoseFrame::map}, {"plan", PoseFrame::plan}};
  return command.add_option("--frame", frame, "Frame of the poses: map, or floor plan of the map (map)")
      ->type_name("map|plan")
      ->transform(one_of(frames));
}

const PlanRegistration& require_plan(const std::optional<PlanRegistration>& plan, const std::filesystem::path& map) {
  if (plan) return *plan;
  throw InputError(map.string(), "is not registered on a floor plan, so poses on a plan are not available",
                   "see \"byre register\"");
}

void declare_trajectory_format(CLI::App& command, TrajectoryFormat& format) {
  const std::map<std::string, TrajectoryFormat> formats = {
      {"tum", TrajectoryFormat::tum}, {"euroc", TrajectoryFormat::euroc}, {"kitti", TrajectoryFormat::kitti}};
  command
      .add_option("--format", format,
                  "Format of the written trajectories: TUM (default), EuRoC with nanoseconds, or KITTI without times")
      ->type_name("tum|euroc|kitti")
      ->transform(one_of(formats));
}

}  // namespace byre::cli
