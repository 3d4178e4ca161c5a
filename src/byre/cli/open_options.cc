#include "byre/cli/open_options.h"

#include "byre/cli/file_arguments.h"
#include "byre/input/text_file.h"

#include <array>
#include <string>

#include <CLI/CLI.hpp>

namespace byre::cli {
namespace {

constexpr std::array kChoices = {CameraChoice::stereo, CameraChoice::left, CameraChoice::right, CameraChoice::rgbd};

std::optional<double> parse_frame_rate(std::string_view text) {
  const std::optional<double> rate = parse_number(text);
  return rate && *rate >= kLowestFrameRate && *rate <= kHighestFrameRate ? rate : std::nullopt;
}

}  // namespace

std::optional<CameraChoice> parse_camera(std::string_view text) {
  for (const CameraChoice choice : kChoices) {
    if (text == to_string(choice)) return choice;
  }
  return std::nullopt;
}

void declare_open_options(CLI::App& command, OpenOptions& options) {
  const auto set_camera = [&options](const std::string& text) {
    options.camera = parse_camera(text);
    if (!options.camera)
      throw CLI::ValidationError("--camera", "\"" + text + "\" is none of stereo, left, right and rgbd");
  };
  const auto set_frame_rate = [&options](const std::string& text) {
    options.frame_rate_hz = parse_frame_rate(text);
    if (!options.frame_rate_hz) throw CLI::ValidationError("--fps", "\"" + text + "\" is no frame rate");
  };
  command
      .add_option_function<std::string>(
          "--camera", set_camera,
          "Take both cameras of the recording, one alone, or the colour camera with depth (all it has)")
      ->type_name("stereo|left|right|rgbd");
  add_input(command, Input::file, "--calibration", options.calibration,
            "Calibration, in place of the recording's own: EuRoC sensor.yaml, OpenCV or ROS YAML, Kalibr camchain")
      ->type_name("FILE");
  command
      .add_option_function<std::string>(
          "--fps", set_frame_rate,
          "Frame rate of images and videos, in place of the times in their names or of what the video says")
      ->type_name("HZ");
}

}  // namespace byre::cli
