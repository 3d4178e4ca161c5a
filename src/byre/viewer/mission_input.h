#pragma once

#include "byre/viewer/plan_picture.h"

#include <filesystem>

namespace byre {

// Path of a mission with verdicts, from a statistics file of "byre run --stats". Throws InputError if the file is none,
// or if its poses are not in the map frame.
PlanPath load_mission(const std::filesystem::path& stats);

}  // namespace byre
