#pragma once

namespace byre {

// What a pair leaves whose images fit together: such a share of the features is found in the right image, usually 0.4
// and more, and the median of their rows is off by no more; worn calibrations leave up to 0.7.
inline constexpr double kLeastStereoShare = 0.12;
inline constexpr double kMostRowOffset = 0.8;  // pixels

}  // namespace byre
