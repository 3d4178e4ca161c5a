#pragma once

#include "byre/cli/draw/options.h"
#include "byre/map/map_file.h"
#include "byre/viewer/mission_painter.h"

#include <string>
#include <vector>

namespace byre::cli {

// A mission as it was run.
struct DrawnMission : PaintedMission {
  MapScene online;  // what was mapped beside the offline map
  std::vector<std::string> warnings;
  bool stopped = false;  // by Ctrl-C
};

// Runs the recording on the map, and writes the video on the way. background: the scene without the mission. Throws
// InputError as opening the recording and the map do, and for a moment that is not in the range.
DrawnMission draw_mission(const DrawOptions& options, StoredMap stored, const PlanScene& background);

}  // namespace byre::cli
