#pragma once

#include "byre/viewer/plan_picture.h"

#include <filesystem>

namespace byre {

// The way of a mission with its verdicts, from the statistics that "byre run --stats" wrote. Throws InputError for a
// file that is none, and for one whose poses are not in the map's frame.
PlanPath load_mission(const std::filesystem::path& stats);

}  // namespace byre
