#pragma once

#include "byre/assessment/mission_report.h"
#include "byre/playback/map_run.h"
#include "byre/playback/scaled_recording.h"

#include <optional>

namespace byre {

// True poses that a mission is judged by.
struct MissionTruth {
  Trajectory of_frames;
  Trajectory of_map;  // poses at the times of the map's own recording
  // Poses, not true ones, of the run that made the map, by which it is aligned to the truth; empty: its keyframes.
  std::optional<Trajectory> map_run;
  Scale map_scale = Scale::fixed;  // whether the alignment of the map may change its scale
};

// What a run came to: in the frame of its offline map, or without one after alignment. Errors only with truth.
MissionOutcome judge_mission(const MapRun& run, const EngineOptions& options, const std::optional<MissionTruth>& truth,
                             const ScaledRecording& recording);

}  // namespace byre
