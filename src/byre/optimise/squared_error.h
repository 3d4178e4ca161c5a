#pragma once

namespace byre {

// Bounds of squared errors, in squared sigmas, that one measurement in twenty exceeds by noise alone.
inline constexpr double kMaxSquaredErrorMono = 5.991;    // 95 % of chi-square, two degrees of freedom: column and row
inline constexpr double kMaxSquaredErrorStereo = 7.815;  // 95 %, three degrees: with the disparity

}  // namespace byre
