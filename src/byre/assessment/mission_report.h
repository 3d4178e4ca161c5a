#pragma once

#include "byre/assessment/mission_errors.h"
#include "byre/assessment/mission_statistics.h"

#include <optional>
#include <string>

#include <nlohmann/json_fwd.hpp>

namespace byre {

// What a run of "byre run" came to.
struct MissionOutcome {
  MissionStatistics statistics;
  std::optional<MissionErrors> errors;  // with truth
};

// Rows for people, each a name and what is known under it.
std::string to_text(const MissionStatistics& statistics);
std::string to_text(const MissionErrors& errors);

nlohmann::ordered_json to_json(const MissionStatistics& statistics);
nlohmann::ordered_json to_json(const MissionErrors& errors);

}  // namespace byre
