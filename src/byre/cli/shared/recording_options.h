#pragma once

#include "byre/cli/shared/method_arguments.h"
#include "byre/recording.h"

#include <optional>

namespace CLI {
class App;
}

namespace byre::cli {

// Help text for recordings.
inline constexpr const char* kRecordingHelp =
    "Recording: folder (EuRoC, KITTI odometry, TUM RGB-D, images), video file, or ROS 1 or ROS 2 bag";

// Declares --camera, --calibration, --baseline, --fps, --wheels, --no-wheels, --gyroscope, --wheels-topic, --imu-topic,
// --left, --right and --pair-tolerance. The options must outlive the parsing of the command line.
void declare_open_options(CLI::App& command, OpenOptions& options);

// --start, --end, --frames and --stride: range of frames of a recording. The range must outlive the parsing of the
// command line.
void declare_frame_range(CLI::App& command, FrameRange& range);

// Throws CLI::ValidationError for an empty range.
void require_valid(const FrameRange& range);

// --pace. The arguments must outlive the parsing of the command line.
void declare_pace(CLI::App& command, MethodArguments& arguments);

}  // namespace byre::cli
