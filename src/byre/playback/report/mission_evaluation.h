#pragma once

#include "byre/playback/play.h"
#include "byre/playback/report/mission_report.h"
#include "byre/playback/scaled_recording.h"

#include <optional>

namespace byre {

// Truth that a mission is evaluated against.
struct MissionTruth {
  Trajectory frames;
  Trajectory map;  // true poses at the times of the map's recording
  // Estimated poses of the mapping run, which align the map to the truth; empty: its keyframes.
  std::optional<Trajectory> map_run;
  Scale map_scale = Scale::fixed;  // whether the alignment of the map estimates scale
};

// Statistics and errors of a run: in the frame of its offline map, or without one after alignment. Errors need truth.
MissionOutcome evaluate_mission(const RunResult& run, const MethodOptions& options,
                                const std::optional<MissionTruth>& truth, const ScaledRecording& recording);

}  // namespace byre
