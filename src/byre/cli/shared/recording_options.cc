#include "byre/cli/shared/recording_options.h"

#include "byre/base/text_file.h"
#include "byre/calibration_file.h"
#include "byre/cli/shared/choice.h"
#include "byre/cli/shared/file_arguments.h"
#include "byre/cli/shared/number_check.h"
#include "byre/geometry/baseline.h"
#include "byre/io/recording/recording_options.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <string>

#include <CLI/CLI.hpp>

namespace byre::cli {
namespace {

constexpr double kLongest_s = 1e9;
constexpr const char* kRightCalibration = "--right-calibration";

std::optional<double> parse_frame_rate(std::string_view text) {
  const std::optional<double> rate = parse_number(text);
  return rate && *rate >= kLowestFrameRate && *rate <= kHighestFrameRate ? rate : std::nullopt;
}

}  // namespace

std::vector<std::string> with_right_calibration(std::vector<std::string> arguments) {
  constexpr std::array kExtensions = {".yaml", ".yml", ".xml", ".json", ".ini"};
  for (std::size_t i = 0; i + 2 < arguments.size(); ++i) {
    if (arguments[i] != "--calibration" || arguments[i + 2].starts_with("-")) continue;
    const std::string second = file_of_camera(arguments[i + 2]).string();
    const bool is_calibration =
        std::ranges::any_of(kExtensions, [&](const char* extension) { return second.ends_with(extension); });
    if (is_calibration) arguments.insert(arguments.begin() + static_cast<std::ptrdiff_t>(i) + 2, kRightCalibration);
  }
  return arguments;
}

void declare_open_options(CLI::App& command, OpenOptions& options) {
  const auto set_camera = [&options](const std::string& text) {
    options.camera = parse_camera(text);
    if (!options.camera)
      throw CLI::ValidationError("--camera", "\"" + text + "\" is not one of stereo, left, right and rgbd");
  };
  const auto set_frame_rate = [&options](const std::string& text) {
    options.frame_rate_hz = parse_frame_rate(text);
    if (!options.frame_rate_hz) throw CLI::ValidationError("--fps", "\"" + text + "\" is not a frame rate");
  };
  command
      .add_option_function<std::string>(
          "--camera", set_camera,
          "Cameras to use: both, one alone, or the colour camera with depth (all cameras of the recording)")
      ->type_name("stereo|left|right|rgbd");
  add_input(command, Input::file, "--calibration", options.calibration,
            "Calibration, replaces that of the recording, in any format that \"byre calibration show\" reads; "
            "two files, LEFT and RIGHT, if each camera has its own; FILE#NAME is one of several cameras")
      ->type_name("FILE");
  add_input(command, Input::file, kRightCalibration, options.right_calibration,
            "Calibration of the right camera, if each camera has its own")
      ->type_name("FILE");
  command
      .add_option(
          "--baseline", options.baseline,
          "Baseline of the cameras, replaces that of the calibration; required to confirm one outside 2 mm to 1 m")
      ->type_name("METRES")
      ->check(between(kShortestConfirmed, kLongestConfirmed));
  command
      .add_option_function<std::string>(
          "--fps", set_frame_rate,
          "Frame rate of images and videos, replaces the times in file names and the frame rate of the video")
      ->type_name("HZ");
  add_input(command, Input::file, "--wheels", options.wheels,
            "Wheel odometry, \"time_s tx ty tz qx qy qz qw\" per line, replaces wheel.txt in the folder")
      ->type_name("FILE");
  command.add_flag("!--no-wheels", options.use_wheels, "Ignore wheel.txt in the folder");
  command.add_flag("--gyroscope", options.use_gyroscope,
                   "Use the gyroscope of the folder (mav0/imu0/data.csv) or of a bag's only sensor_msgs/Imu topic");
  add_text(command, "--wheels-topic", options.wheels_topic,
           "Topic of wheel odometry in a bag, nav_msgs/Odometry or twists")
      ->type_name("TOPIC");
  add_text(command, "--imu-topic", options.imu_topic, "Topic of the gyroscope in a bag, sensor_msgs/Imu")
      ->type_name("TOPIC");
  add_text(command, "--left", options.left_topic, "Topic of the left or only camera's images in a bag")
      ->type_name("TOPIC");
  add_text(command, "--right", options.right_topic, "Topic of the right camera's images in a bag")->type_name("TOPIC");
  add_text(command, "--depth", options.depth_topic, "Topic of the depth images in a bag")->type_name("TOPIC");
  command
      .add_option("--pair-tolerance", options.pair_tolerance_s,
                  "Maximum difference between the time stamps of left and right image of a pair (0.002)")
      ->type_name("SECONDS")
      ->check(between(0.0, 0.5));
}

void declare_frame_range(CLI::App& command, FrameRange& range) {
  command.add_option("--start", range.start_s, "Start this long after the recording's first frame")
      ->type_name("SECONDS")
      ->check(between(0.0, kLongest_s));
  command.add_option("--end", range.end_s, "End this long after the recording's first frame, exclusive")
      ->type_name("SECONDS")
      ->check(between(0.0, kLongest_s));
  const auto set_frames = [&range](const std::string& text) {
    const std::optional<FrameRange> frames = parse_frames(text);
    if (!frames) throw CLI::ValidationError("--frames", "\"" + text + "\" is not a range of frames such as 0:150");
    range.first = frames->first;
    range.last = frames->last;
  };
  command
      .add_option_function<std::string>("--frames", set_frames,
                                        "Frames of the recording, counted from 0, END exclusive; both are optional")
      ->type_name("FIRST:END");
  command.add_option("--stride", range.stride, "Use every n-th frame of the range")
      ->type_name("N")
      ->check(between(1, 1'000'000))
      ->capture_default_str();
}

void require_valid(const FrameRange& range) {
  if (range.start_s && range.end_s && *range.start_s >= *range.end_s) {
    throw CLI::ValidationError("--start", "must be less than --end");
  }
}

void declare_pace(CLI::App& command, MethodArguments& arguments) {
  declare_method_option(command, "--pace", "pace", arguments, "Thread of mapping and feeding rate of frames");
}

}  // namespace byre::cli
