#pragma once

#include "byre/viewer/picture.h"

#include <opencv2/core.hpp>

namespace byre {

// How symbols look in any of the ways to draw a picture.

// The filled ones, about the origin. Precondition: square, diamond or triangle.
std::vector<Eigen::Vector2d> corners_of(Symbol symbol, double size);

// The others, about the origin: pairs of ends. Precondition: cross or plus.
std::vector<std::pair<Eigen::Vector2d, Eigen::Vector2d>> strokes_of(Symbol symbol, double size);
double stroke_width(double size);

bool is_stroked(Symbol symbol);

inline constexpr double kRim = 1.0;      // pixels around a symbol
inline constexpr double kDash = 2.5;     // widths of a dashed line along a dash
inline constexpr double kDashGap = 2.0;  // widths of a dashed line between dashes
inline constexpr double kDotGap = 2.0;   // widths of a dotted line from dot to dot; a dot is a width across

// Draws it at its own size: BGR.
cv::Mat rasterised(const Picture& picture);

}  // namespace byre
