#pragma once

#include "byre/geometry/evaluation/evaluate.h"

#include <string>

namespace byre {

// SVG picture: true and aligned estimated path from above, and the position error over time below. The view is along z,
// or along y for KITTI truth, whose y points down. Precondition: the report has an absolute error of these
// trajectories.
std::string evaluation_plot(const EvaluationReport& report, const Trajectory& estimate, const Trajectory& truth,
                            bool y_points_down);

}  // namespace byre
