#pragma once

#include "byre/playback/map_run.h"

#include <string>

namespace byre {

// Rows of a report: what was found out of wheels and a gyroscope, and how many poses went on by them alone. Empty where
// nothing told the motion. sees_metres: cameras do, as a pair or on a map.
std::string motion_rows(const MapRun& run, bool sees_metres);

}  // namespace byre
