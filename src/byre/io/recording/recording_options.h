#pragma once

#include "byre/recording.h"

#include <optional>
#include <string_view>

namespace byre {

// Syntax of command lines and protocols for frames and cameras of a recording.

// "FIRST:END", END exclusive; either may be omitted. Empty for anything else, and for an empty range.
std::optional<FrameRange> parse_frames(std::string_view text);

// One of stereo, left, right and rgbd; empty for anything else.
std::optional<CameraChoice> parse_camera(std::string_view text);

// Range of frame rates that may be given, Hz.
inline constexpr double kLowestFrameRate = 0.01, kHighestFrameRate = 10'000.0;

}  // namespace byre
