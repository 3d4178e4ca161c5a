#pragma once

#include "aligned_map.h"
#include "mission_case.h"
#include "start_run.h"

#include "byre/recording.h"

#include <functional>
#include <string>
#include <vector>

namespace byre {

// Missions that start all along a barn, on a map of another visit.
struct StartCase {
  std::string name;
  MapChoice map;
  std::string mission;  // name of the barn's recording
  StartPlan plan{};
  OpenOptions open{.use_wheels = true, .use_gyroscope = true};
  bool is_long_run = false;  // see MissionCase
};

const std::vector<StartCase>& start_cases();

// Empty: both recordings are complete; otherwise which one is missing, with the remedy.
std::optional<std::string> what_is_missing(const StartCase& start_case);

// The missions have the camera of the map. Throws InputError for damaged recordings.
StartTotals run(const StartCase& start_case, const AlignedMap& known,
                const std::function<void(const StartedMission&)>& each);

}  // namespace byre
