#pragma once

#include "byre/assessment/mission_report.h"
#include "byre/playback/map_run.h"
#include "byre/playback/scaled_recording.h"

#include <optional>

namespace byre {

// True poses that a mission is judged by.
struct MissionTruth {
  Trajectory of_frames;
  Trajectory of_map;                  // at the times of the map's own recording
  std::optional<Trajectory> map_run;  // not true: all poses of the run that made the map, by which it is aligned to the
                                      // truth; else its keyframes
  Scale map_scale = Scale::fixed;     // of that alignment
};

// What a run came to: in the frame of its offline map, or without one after alignment. Errors only with truth.
MissionOutcome judge_mission(const MapRun& run, const EngineOptions& options, const std::optional<MissionTruth>& truth,
                             const ScaledRecording& recording);

}  // namespace byre
