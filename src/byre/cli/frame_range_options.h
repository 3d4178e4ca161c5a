#pragma once

#include "byre/recording.h"

#include <optional>
#include <string_view>

#include <CLI/App.hpp>

namespace byre::cli {

// --start, --end, --frames and --stride: which frames of a recording a command works on. The range must outlive the
// parsing of the command line.
void declare_frame_range(CLI::App& command, FrameRange& range);

// Throws CLI::ValidationError for a range that cannot hold a frame.
void require_sense(const FrameRange& range);

// "FIRST:END", END exclusive; either may be left out. Empty for anything else, and for a range without a frame.
std::optional<FrameRange> parse_frames(std::string_view text);

}  // namespace byre::cli
