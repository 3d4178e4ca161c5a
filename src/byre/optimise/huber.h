#pragma once

#include <algorithm>
#include <cmath>

namespace byre {

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
