#pragma once

#include "byre/plan_registration.h"
#include "byre/trajectory_file.h"

#include <cstdint>
#include <filesystem>
#include <optional>

namespace CLI {
class App;
class Option;
}  // namespace CLI

namespace byre::cli {

// Frame of poses in output files.
enum class PoseFrame : std::uint8_t { map, plan };

// Declares --frame.
CLI::Option* declare_pose_frame(CLI::App& command, PoseFrame& frame);

// Registration of a map on its floor plan. Throws InputError with the map's file if there is none.
const PlanRegistration& require_plan(const std::optional<PlanRegistration>& plan, const std::filesystem::path& map);

// --format of all trajectories that a command writes. The format must outlive the parsing of the command line.
void declare_trajectory_format(CLI::App& command, TrajectoryFormat& format);

}  // namespace byre::cli
