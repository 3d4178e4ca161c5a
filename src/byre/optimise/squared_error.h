#pragma once

namespace byre {

// Bounds of squared errors, in squared sigmas; 5 % of correct measurements exceed them.
inline constexpr double kMaxSquaredErrorMono = 5.991;    // 95 % of chi-square, two degrees of freedom: column and row
inline constexpr double kMaxSquaredErrorStereo = 7.815;  // 95 % of chi-square, three degrees of freedom: with disparity

}  // namespace byre
