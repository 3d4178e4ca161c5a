#pragma once

#include "byre/cli/draw/mission_painter.h"
#include "byre/cli/draw/options.h"
#include "byre/map/map_file.h"

#include <string>
#include <vector>

namespace byre::cli {

// Mission to draw.
struct DrawnMission : PaintedMission {
  MapScene online;  // online map
  std::vector<std::string> warnings;
  bool stopped = false;  // whether Ctrl-C stopped it
};

// Runs the recording on the map, and writes the video. background: scene without the mission. Throws InputError as
// opening the recording and the map do, and for a time outside the range.
DrawnMission draw_mission(const DrawOptions& options, const PlanScene& background);

}  // namespace byre::cli
