#pragma once

#include "byre/evaluation/evaluate.h"

#include <string>

namespace byre {

// An SVG picture: the true and the aligned estimated path from above, and below it the error of the position over time.
// From above means along z, or along y where the truth is KITTI's, whose y points down. Precondition: the report has an
// absolute error, of these trajectories.
std::string evaluation_plot(const EvaluationReport& report, const Trajectory& estimate, const Trajectory& truth,
                            bool y_points_down);

}  // namespace byre
