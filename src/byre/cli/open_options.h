#pragma once

#include "byre/recording.h"

#include <optional>
#include <string_view>

#include <CLI/App.hpp>

namespace byre::cli {

// How formats of recordings are told of in the help of a command.
inline constexpr const char* kRecordingHelp =
    "Folder of a recording (EuRoC, KITTI odometry, TUM RGB-D, images), or a video file";

// --camera, --calibration and --fps: how a command takes a recording. The options must outlive the parsing of the
// command line.
void declare_open_options(CLI::App& command, OpenOptions& options);

// One of stereo, left, right and rgbd; empty for anything else.
std::optional<CameraChoice> parse_camera(std::string_view text);

// Range of frame rates that may be given, Hz.
inline constexpr double kLowestFrameRate = 0.01, kHighestFrameRate = 10'000.0;

}  // namespace byre::cli
