#pragma once

#include "byre/playback/report/mission_errors.h"
#include "byre/playback/report/mission_statistics.h"

#include <optional>
#include <string>

#include <nlohmann/json_fwd.hpp>

namespace byre {

struct MissionOutcome {
  MissionStatistics statistics;
  std::optional<MissionErrors> errors;  // only with truth
};

// Rows of a name and a value.
std::string to_text(const MissionStatistics& statistics);
std::string to_text(const MissionErrors& errors);

nlohmann::ordered_json to_json(const MissionStatistics& statistics);
nlohmann::ordered_json to_json(const MissionErrors& errors);

}  // namespace byre
