#pragma once

#include "byre/benchmark/benchmark_run.h"
#include "byre/geometry/evaluation/evaluate.h"
#include "byre/trajectory.h"

#include <cstddef>
#include <string>
#include <vector>

#include <Eigen/Core>

namespace byre {

// A polyline, in several pieces if it has gaps.
struct ChartSeries {
  std::string name;
  std::string colour;  // SVG colour: "#0072b2"
  double width = 1.6;  // pixels
  std::vector<std::vector<Eigen::Vector2d>> pieces;
};

// Polyline through samples, with gaps where consecutive times differ by more than longest_step.
template <typename Sample, typename PointOf>
std::vector<std::vector<Eigen::Vector2d>> line_through(const std::vector<Sample>& samples, Timestamp longest_step,
                                                       PointOf point_of) {
  std::vector<std::vector<Eigen::Vector2d>> pieces;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    if (i == 0 || samples[i].time - samples[i - 1].time > longest_step) pieces.emplace_back();
    pieces.back().push_back(point_of(samples[i]));
  }
  return pieces;
}

inline constexpr const char* kTruthColour = "#b8b8b4";
inline constexpr double kTruthWidth = 5.0;  // pixels, wide enough to show beneath other series

struct Chart {
  std::string title;
  std::string subtitle;
  std::string x_label;  // with the unit
  std::string y_label;
  bool equal_scales = false;             // whether both axes have one scale
  bool log_y = false;                    // omits values that are not positive
  std::vector<ChartSeries> series = {};  // drawn in this order, the last on top
};

// A stand-alone picture, 860 pixels wide, on a light background; axes with ticks, and a legend.
std::string to_svg(const Chart& chart);

std::string to_svg(const std::vector<Chart>& charts);

// Round values in a range, ascending: at least four, at most ten intervals. Precondition: least < most.
std::vector<double> round_ticks(double least, double most);

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
