#pragma once

#include "byre/cli/draw_options.h"
#include "byre/cli/interrupt.h"
#include "byre/viewer/plan_picture.h"
#include "byre/viewer/scene.h"

#include <optional>
#include <string>
#include <vector>

namespace byre::cli {

// What is kept of a mission to draw it.
struct DrawnMission {
  PlanPath way;                     // poses as published, with their verdicts
  MapScene online;                  // what was mapped beside the offline map
  std::optional<FrameScene> frame;  // that of the camera picture; empty when no frame could be read up to then
  std::optional<double> frame_s;    // its time, from the recording's first frame
  std::optional<Rig> rig;           // that took it
  int video_frames = 0;
  bool plays_in_browsers = false;  // the video
  std::vector<std::string> warnings;
  bool stopped = false;  // by Ctrl-C
};

// Runs the recording on the map, and writes the video on the way. background: the scene without the mission. Throws
// InputError as opening the recording and the map do, and for a moment that is not in the range.
DrawnMission draw_mission(const DrawOptions& options, StoredMap stored, const PlanScene& background);

}  // namespace byre::cli
