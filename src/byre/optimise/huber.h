#pragma once

#include <algorithm>
#include <cmath>

namespace byre {

// Huber's loss of a residual's squared length: unchanged within the width, growing with the plain length beyond.
inline double huber_cost(double squared_error, double width) {
  const double length = std::sqrt(squared_error);
  const double within = std::min(length, width);
  return within * (2.0 * length - within);
}

// Its derivative: the influence left to the residual, 1 within the width.
inline double huber_weight(double squared_error, double width) {
  return width / std::max(width, std::sqrt(squared_error));
}

}  // namespace byre
