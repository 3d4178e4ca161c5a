#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

namespace byre::cli {

// Points joined by lines; several pieces where there are gaps.
struct ChartSeries {
  std::string name;    // in the legend
  std::string colour;  // as SVG names it: "#0072b2"
  double width = 1.6;  // pixels
  std::vector<std::vector<Eigen::Vector2d>> pieces;
};

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

}  // namespace byre::cli
