#pragma once

#include "byre/trajectory.h"

#include <cstddef>
#include <string>
#include <vector>

#include <Eigen/Core>

namespace byre {

// Points joined by lines; several pieces where there are gaps.
struct ChartSeries {
  std::string name;    // in the legend
  std::string colour;  // as SVG names it: "#0072b2"
  double width = 1.6;  // pixels
  std::vector<std::vector<Eigen::Vector2d>> pieces;
};

// A line that breaks where samples are further apart in time than that.
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
inline constexpr double kTruthWidth = 5.0;  // pixels, to be seen beneath the others

struct Chart {
  std::string title;
  std::string subtitle;
  std::string x_label;  // with the unit
  std::string y_label;
  bool equal_scales = false;             // a metre is as long on both axes
  bool log_y = false;                    // values that are not positive are left out
  std::vector<ChartSeries> series = {};  // drawn in this order, so the last lies on top
};

// A picture of its own, 860 pixels wide, on a light background; axes with ticks, and a legend.
std::string to_svg(const Chart& chart);

// Several, one below the other.
std::string to_svg(const std::vector<Chart>& charts);

// Round values in a range, ascending: at least four, and so that they divide it into ten parts at most. Precondition:
// least < most.
std::vector<double> round_ticks(double least, double most);

}  // namespace byre
