#include "byre/cli/shared/options.h"

#include "byre/base/printable.h"
#include "byre/base/text_file.h"
#include "byre/calibration_file.h"
#include "byre/cli/shared/arguments.h"
#include "byre/geometry/baseline.h"
#include "byre/input_error.h"
#include "byre/io/calibration/calibration_fields.h"
#include "byre/io/recording/frame_selection.h"
#include "byre/playback/options_file.h"
#include "byre/slam/system/option_table.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <iostream>
#include <map>
#include <stdexcept>

#include <CLI/CLI.hpp>
#include <fmt/core.h>

namespace byre::cli {
namespace {

// Checks and keeps a setting.
void add_setting(const std::string& flag, const std::string& name, const std::string& text,
                 MethodArguments& arguments) {
  MethodOptions scratch;
  if (const auto fault = set_option(scratch, name, text)) {
    throw CLI::ValidationError(flag, printable(fault->reason) + "; " + fault->remedy);
  }
  arguments.settings.emplace_back(name, text);
}

constexpr double kLongest_s = 1e9;
constexpr const char* kRightCalibration = "--right-calibration";

std::optional<double> parse_frame_rate(std::string_view text) {
  const std::optional<double> rate = parse_number(text);
  return rate && *rate >= kLowestFrameRate && *rate <= kHighestFrameRate ? rate : std::nullopt;
}

namespace fs = std::filesystem;

// The file of a calibration, given as file or folder, if it has extrinsics among its fields.
std::optional<fs::path> file_with_extrinsics(const fs::path& calibration) {
  const auto file = fs::is_directory(calibration) ? find_calibration(calibration) : std::optional(calibration);
  if (!file || fs::is_directory(*file)) return std::nullopt;  // a folder of two files has no common fields
  const std::vector<std::string> names = CalibrationFields::load(*file).names();
  const auto is_pose = [](const std::string& name) { return name.starts_with("base_from"); };
  return std::ranges::any_of(names, is_pose) ? file : std::nullopt;
}

}  // namespace

MethodOptions MethodArguments::options() const {
  MethodOptions options;
  if (file) read_options(*file, options);
  if (is_live) options.pace = Pace::live;
  for (const auto& [name, text] : settings) set_option(options, name, text);
  return options;
}

void declare_method_option(CLI::App& command, const std::string& flag, const std::string& name,
                           MethodArguments& arguments, const std::string& help) {
  const auto option = std::ranges::find(option_table(), name, &MethodOption::name);
  if (option == option_table().end()) throw std::logic_error("no option " + name);
  const bool is_choice = option->range.find('|') != std::string::npos;
  const auto keep = [flag, name, &arguments](const std::string& text) { add_setting(flag, name, text, arguments); };
  command.add_option_function<std::string>(flag, keep, fmt::format("{} ({})", help, option->get({})))
      ->type_name(is_choice ? option->range : "NUMBER");
}

CLI::Option* declare_method_flag(CLI::App& command, const std::string& flag, const std::string& name,
                                 const std::string& value, MethodArguments& arguments, const std::string& help) {
  return command.add_flag_callback(
      flag, [=, &arguments] { add_setting(flag, name, value, arguments); }, help);
}

void declare_options_file(CLI::App& command, MethodArguments& arguments) {
  add_input(command, Input::file, "--options", arguments.file,
            "Options of the method as printed by --print-options; command line options win over the file")
      ->type_name("YAML");
  const auto keep = [&arguments](const std::vector<std::string>& settings) {
    for (const std::string& setting : settings) {
      const std::size_t equals = setting.find('=');
      if (equals == std::string::npos) {
        throw CLI::ValidationError("--set", "'" + printable(setting) + "' has no value; give NAME=VALUE");
      }
      add_setting("--set", setting.substr(0, equals), setting.substr(equals + 1), arguments);
    }
  };
  command
      .add_option_function<std::vector<std::string>>(
          "--set", keep, "One option of the method, such as tracking.min_inliers=20; --print-options lists all")
      ->type_name("NAME=VALUE")
      ->expected(1)
      ->take_all();
  const auto print = [&arguments] {
    std::cout << options_file(arguments.options()) << std::flush;
    if (!std::cout) throw std::runtime_error("the options cannot be written to the standard output");
    throw CLI::Success();
  };
  command.add_flag_callback("--print-options", print, "Print the resulting values of all options as YAML, and exit");
}

void declare_vocabulary_option(CLI::App& command, std::optional<std::filesystem::path>& vocabulary) {
  add_input(command, Input::file, "--vocabulary", vocabulary, "Vocabulary for place recognition (the built-in one)");
}

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
            "two files, LEFT and RIGHT, if each camera has its own; FILE#NAME is one of several cameras");
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
            "Wheel odometry, \"time_s tx ty tz qx qy qz qw\" per line, replaces wheel.txt in the folder");
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

void declare_recording(CLI::App& command, std::optional<std::filesystem::path>& record, bool& with_images) {
  CLI::Option* const file = add_output(command, Output::mcap, "--record", record,
                                       "MCAP file of poses, diagnostics, events and map as ROS 2 messages");
  command
      .add_flag("--record-images", with_images, "Record images and camera info too, so that the file can be run again")
      ->needs(file);
}

CLI::Option* declare_pose_frame(CLI::App& command, PoseFrame& frame) {
  const std::map<std::string, PoseFrame> frames = {{"map", PoseFrame::map}, {"plan", PoseFrame::plan}};
  return command.add_option("--frame", frame, "Frame of the poses: map, or floor plan of the map (map)")
      ->type_name("map|plan")
      ->transform(one_of(frames));
}

const PlanRegistration& require_plan(const std::optional<PlanRegistration>& plan, const std::filesystem::path& map) {
  if (plan) return *plan;
  throw InputError(map.string(), "is not registered on a floor plan, so poses on a plan are not available",
                   "see \"byre register\"");
}

void declare_trajectory_format(CLI::App& command, TrajectoryFormat& format) {
  const std::map<std::string, TrajectoryFormat> formats = {
      {"tum", TrajectoryFormat::tum}, {"euroc", TrajectoryFormat::euroc}, {"kitti", TrajectoryFormat::kitti}};
  command
      .add_option("--format", format,
                  "Format of the written trajectories: TUM (default), EuRoC with nanoseconds, or KITTI without times")
      ->type_name("tum|euroc|kitti")
      ->transform(one_of(formats));
}

std::optional<Extrinsics> ExtrinsicsArguments::read(const OpenOptions& open) const {
  std::optional<fs::path> path = file;
  if (!path && open.calibration) path = file_with_extrinsics(*open.calibration);
  if (!path) return std::nullopt;
  if (open.camera == CameraChoice::right) {
    throw InputError(path->string(), "has the pose of the left camera, and --camera right uses the other one",
                     "leave out --extrinsics, or use --camera left");
  }
  return read_extrinsics(*path, frames);
}

void declare_extrinsics(CLI::App& command, ExtrinsicsArguments& arguments) {
  CLI::Option* const file = add_input(
      command, Input::recording, "--extrinsics", arguments.file,
      "Poses of camera and IMU on the robot's base: YAML, URDF, or a bag with /tf_static (those in the file of "
      "--calibration, else estimated while driving)");
  const auto add_frame = [&](const std::string& name, std::string& frame, const std::string& help) {
    add_text(command, name, frame, help)->type_name("NAME")->needs(file);
  };
  add_frame("--base-frame", arguments.frames.base,
            "Frame of the base in a URDF or bag (base_link, else base_footprint)");
  add_frame("--camera-frame", arguments.frames.camera,
            "Optical frame of the left or only camera in a URDF or bag (the only one that ends in optical_frame)");
  add_frame("--imu-frame", arguments.frames.imu, "Frame of the IMU in a URDF or bag (imu_link)");
}

}  // namespace byre::cli
