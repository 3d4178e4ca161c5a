#pragma once

#include "byre/viewer/picture.h"

#include <opencv2/core.hpp>

namespace byre {

// Shapes of symbols, common to all renderers.

// Corners about the origin. Precondition: square, diamond or triangle.
std::vector<Eigen::Vector2d> corners_of(Symbol symbol, double size);

// Pairs of stroke ends about the origin. Precondition: cross or plus.
std::vector<std::pair<Eigen::Vector2d, Eigen::Vector2d>> strokes_of(Symbol symbol, double size);
double stroke_width(double size);

bool is_stroked(Symbol symbol);

inline constexpr double kRim = 1.0;      // width of the rim of a symbol, pixels
inline constexpr double kDash = 2.5;     // length of a dash, in line widths
inline constexpr double kDashGap = 2.0;  // gap between dashes, in line widths
inline constexpr double kDotGap = 2.0;   // distance of dots, in line widths; a dot is one width across

// Renders at the picture's size, BGR.
cv::Mat rasterised(const Picture& picture);

}  // namespace byre
