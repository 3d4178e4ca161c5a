#pragma once

#include <numbers>

namespace byre {

inline constexpr double kDegree = std::numbers::pi / 180.0;  // radians

}  // namespace byre
