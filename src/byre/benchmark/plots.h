#pragma once

#include "byre/benchmark/benchmark_run.h"
#include "byre/benchmark/chart.h"
#include "byre/geometry/evaluation/evaluate.h"

#include <string>

namespace byre {

// View from above in the truth's frame: truth in grey, and final poses of each arm's first run.
Chart path_chart(const CaseResult& result);

// Error over time of the causal poses of each arm's first run.
Chart error_chart(const CaseResult& result);

// SVG picture: true and aligned estimated path from above, and the position error over time below. The view is along z,
// or along y for KITTI truth, whose y points down. Precondition: the report has an absolute error of these
// trajectories.
std::string evaluation_plot(const EvaluationReport& report, const Trajectory& estimate, const Trajectory& truth,
                            bool y_points_down);

}  // namespace byre
