#pragma once

#include "byre/recording.h"

#include <optional>
#include <string_view>

namespace byre {

// How command lines and protocols say which frames and cameras of a recording they mean.

// "FIRST:END", END exclusive; either may be left out. Empty for anything else, and for a range without a frame.
std::optional<FrameRange> parse_frames(std::string_view text);

// One of stereo, left, right and rgbd; empty for anything else.
std::optional<CameraChoice> parse_camera(std::string_view text);

// Range of frame rates that may be given, Hz.
inline constexpr double kLowestFrameRate = 0.01, kHighestFrameRate = 10'000.0;

}  // namespace byre
