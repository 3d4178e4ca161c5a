#pragma once

#include "byre/benchmark/measures.h"
#include "byre/evaluation/map_frame_error.h"
#include "byre/playback/map_run.h"

#include <optional>
#include <vector>

namespace byre {

// What a run is compared with.
struct RunTruth {
  const Trajectory& poses;          // true poses at the times of the recording
  std::optional<MapAlignment> map;  // alignment of the run's offline map to the truth; empty for a run without one
  Scale scale = Scale::fixed;       // free for one camera without a map
};

// All but memory and CPU time, which the run itself does not tell.
RunMeasures judge(const MapRun& run, const RunTruth& truth);

// Where a run was at a time, and how far off.
struct TracePoint {
  Timestamp time{};
  Eigen::Vector3d position_in_truth;
  double error = 0.0;  // metres
};

// In the map's frame where there is a map, else after alignment. Empty where that is impossible.
std::vector<TracePoint> trace_of(const Trajectory& estimate, const RunTruth& truth);

}  // namespace byre
