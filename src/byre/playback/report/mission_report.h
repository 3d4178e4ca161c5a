#pragma once

#include "byre/playback/report/mission_errors.h"
#include "byre/playback/report/mission_statistics.h"
#include "byre/playback/report/report.h"

#include <optional>

namespace byre {

struct MissionOutcome {
  MissionStatistics statistics;
  std::optional<MissionErrors> errors;  // only with truth
};

Report mission_report(const MissionStatistics& statistics);
Report mission_error_report(const MissionErrors& errors);

}  // namespace byre
