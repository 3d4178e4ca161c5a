#pragma once

#include "byre/playback/archive/register_map.h"
#include "byre/playback/report/report.h"

#include <optional>
#include <string>

namespace byre {

// Input and output files of a registration; written: empty if nothing was written.
struct RegisterProtocol {
  std::string map;
  FloorPlan plan;
  std::string written;
  std::optional<double> scaled_by;  // set if scale correction was requested; 1: no correction needed
};

Report registration_report(const Registering& registering, const RegisterProtocol& protocol);

}  // namespace byre
