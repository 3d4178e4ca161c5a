#pragma once

#include "byre/extrinsics_file.h"
#include "byre/plan_registration.h"
#include "byre/recording.h"
#include "byre/slam/system/method_options.h"
#include "byre/trajectory_file.h"

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace CLI {
class App;
class Option;
}  // namespace CLI

namespace byre::cli {

// Options of the method on the command line. Settings win over the file; later ones win over earlier ones.
struct MethodArguments {
  std::optional<std::filesystem::path> file;                  // value of --options
  bool is_live = false;                                       // whether live cameras set the pace
  std::vector<std::pair<std::string, std::string>> settings;  // name in the option table, value

  // Throws InputError for faults of the file.
  MethodOptions options() const;
};

// Option of the option table under a name of its own: values, range and default come from the table. The arguments must
// outlive the parsing of the command line.
void declare_method_option(CLI::App& command, const std::string& flag, const std::string& name,
                           MethodArguments& arguments, const std::string& help);
// Flag that sets an option of the table to a value.
CLI::Option* declare_method_flag(CLI::App& command, const std::string& flag, const std::string& name,
                                 const std::string& value, MethodArguments& arguments, const std::string& help);

// --options, --set and --print-options, which prints the resulting options and ends the program. Declare them after the
// options above.
void declare_options_file(CLI::App& command, MethodArguments& arguments);

// --vocabulary
void declare_vocabulary_option(CLI::App& command, std::optional<std::filesystem::path>& vocabulary);

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

// --record and --record-images. The options must outlive the parsing of the command line.
void declare_recording(CLI::App& command, std::optional<std::filesystem::path>& record, bool& with_images);

// Frame of poses in output files.
enum class PoseFrame : std::uint8_t { map, plan };

// Declares --frame.
CLI::Option* declare_pose_frame(CLI::App& command, PoseFrame& frame);

// Registration of a map on its floor plan. Throws InputError with the map's file if there is none.
const PlanRegistration& require_plan(const std::optional<PlanRegistration>& plan, const std::filesystem::path& map);

// --format of all trajectories that a command writes. The format must outlive the parsing of the command line.
void declare_trajectory_format(CLI::App& command, TrajectoryFormat& format);

// Extrinsics of the robot on the command line.
struct ExtrinsicsArguments {
  std::optional<std::filesystem::path> file;
  ExtrinsicsFrames frames;

  // Extrinsics of the file, else those among the fields of the calibration given to open the recording; empty if
  // neither has any. Throws InputError for faults of the file.
  std::optional<Extrinsics> read(const OpenOptions& open) const;
};

// --extrinsics, --base-frame, --camera-frame and --imu-frame. The arguments must outlive the parsing.
void declare_extrinsics(CLI::App& command, ExtrinsicsArguments& arguments);

}  // namespace byre::cli
