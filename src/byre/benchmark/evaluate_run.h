#pragma once

#include "byre/benchmark/measures.h"
#include "byre/geometry/evaluation/map_frame_error.h"
#include "byre/playback/play.h"

#include <optional>
#include <vector>

namespace byre {

struct RunTruth {
  const Trajectory& poses;          // true poses at the recording's times
  std::optional<MapAlignment> map;  // alignment of the run's offline map; empty without one
  Scale scale = Scale::fixed;       // free for a monocular run without a map
};

// All measures except memory and CPU time, which a RunResult does not contain.
RunMeasures evaluate_run(const RunResult& run, const RunTruth& truth);

struct TracePoint {
  Timestamp time{};
  Eigen::Vector3d position_in_truth;
  double error = 0.0;  // metres
};

// In the map's frame with a map, else after alignment. Empty if there is no alignment.
std::vector<TracePoint> trace_of(const Trajectory& estimate, const RunTruth& truth);

}  // namespace byre
