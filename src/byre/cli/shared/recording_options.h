#pragma once

#include "byre/cli/shared/method_arguments.h"
#include "byre/recording.h"

#include <optional>
#include <string>
#include <vector>

namespace CLI {
class App;
}

namespace byre::cli {

// Help text for recordings.
inline constexpr const char* kRecordingHelp =
    "Recording: folder (EuRoC, KITTI odometry, TUM RGB-D, images), video file, or ROS 1 or ROS 2 bag";

// Program arguments in which a second calibration file after --calibration has an option of its own. CLI11 would take
// it for the recording.
std::vector<std::string> with_right_calibration(std::vector<std::string> arguments);

// Declares --camera, --calibration, --right-calibration, --baseline, --fps, --wheels, --no-wheels, --gyroscope,
// --wheels-topic, --imu-topic, --left, --right, --depth and --pair-tolerance. The options must outlive the parsing of
// the command line.
void declare_open_options(CLI::App& command, OpenOptions& options);

// --start, --end, --frames and --stride: range of frames of a recording. The range must outlive the parsing of the
// command line.
void declare_frame_range(CLI::App& command, FrameRange& range);

// Throws CLI::ValidationError for an empty range.
void require_valid(const FrameRange& range);

// --pace. The arguments must outlive the parsing of the command line.
void declare_pace(CLI::App& command, MethodArguments& arguments);

}  // namespace byre::cli
