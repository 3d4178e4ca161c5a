#pragma once

#include "byre/playback/report/report.h"
#include "byre/slam/upkeep/update_map.h"

namespace byre {

struct UpdateProtocol {
  std::string map;                // file of the parent
  std::string written;            // file of the child
  int keyframes = 0, points = 0;  // parent map
};

// What an update added, retired and proved, or why there is no child.
Report update_report(const MapUpdate& update, const UpdateProtocol& protocol);

}  // namespace byre
