#pragma once

#include <algorithm>
#include <cmath>

namespace byre {

// Bounds of squared errors, in squared sigmas; 5 % of correct measurements exceed them.
inline constexpr double kMaxSquaredErrorMono = 5.991;    // 95 % of chi-square, two degrees of freedom: column and row
inline constexpr double kMaxSquaredErrorStereo = 7.815;  // 95 % of chi-square, three degrees of freedom: with disparity

// Huber loss of a squared error: quadratic up to the width, linear beyond.
inline double huber_cost(double squared_error, double width) {
  const double length = std::sqrt(squared_error);
  const double within = std::min(length, width);
  return within * (2.0 * length - within);
}

// Derivative of huber_cost: the weight of the residual, 1 within the width.
inline double huber_weight(double squared_error, double width) {
  return width / std::max(width, std::sqrt(squared_error));
}

}  // namespace byre
