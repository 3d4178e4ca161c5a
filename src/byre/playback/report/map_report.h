#pragma once

#include "byre/playback/archive/register_map.h"
#include "byre/playback/report/report.h"
#include "byre/slam/system/slam_impl.h"
#include "byre/slam/upkeep/update_map.h"

#include <optional>
#include <string>

namespace byre {

Report finish_report(const FinishResult& finishing);

struct UpdateProtocol {
  std::string map;                // file of the parent
  std::string written;            // file of the child
  int keyframes = 0, points = 0;  // parent map
};

// What an update added, retired and proved, or why there is no child.
Report update_report(const MapUpdate& update, const UpdateProtocol& protocol);

// Input and output files of a registration; written: empty if nothing was written.
struct RegisterProtocol {
  std::string map;
  FloorPlan plan;
  std::string written;
  std::optional<double> scaled_by;  // set if scale correction was requested; 1: no correction needed
};

Report registration_report(const Registering& registering, const RegisterProtocol& protocol);

}  // namespace byre
