#pragma once

#include "byre/map/plan_registration.h"
#include "byre/playback/map_run.h"

#include <cstdint>
#include <filesystem>
#include <optional>

#include <CLI/App.hpp>

namespace byre::cli {

// The frame that poses in a map are written in.
enum class PoseFrame : std::uint8_t { map, plan };

// The option --frame.
CLI::Option* declare_pose_frame(CLI::App& command, PoseFrame& frame);

// Where the map lies on its floor plan. Throws InputError, naming the map's file, when that is not known.
const PlanRegistration& require_plan(const std::optional<PlanRegistration>& plan, const std::filesystem::path& map);

// Poses in the map, on its floor plan. Their covariances, as seen in the body, stay as they are: relative to the map's
// origin, and without what the registration adds.
Trajectory on_plan(Trajectory trajectory, const PlanRegistration& registration);
MappedFrame on_plan(MappedFrame frame, const PlanRegistration& registration);
MapRun on_plan(MapRun run, const PlanRegistration& registration);  // all but odometry and the map itself

}  // namespace byre::cli
