#include "byre/cli/open_options.h"

#include <array>
#include <map>
#include <string>

#include <CLI/CLI.hpp>

namespace byre::cli {
namespace {

constexpr std::array kChoices = {CameraChoice::stereo, CameraChoice::left, CameraChoice::right};

}  // namespace

std::optional<CameraChoice> parse_camera(std::string_view text) {
  for (const CameraChoice choice : kChoices) {
    if (text == to_string(choice)) return choice;
  }
  return std::nullopt;
}

void declare_open_options(CLI::App& command, OpenOptions& options) {
  std::map<std::string, CameraChoice> choices;
  for (const CameraChoice choice : kChoices) choices.emplace(to_string(choice), choice);
  command
      .add_option("--camera", options.camera, "Take both cameras of the recording or one alone (both where it has two)")
      ->type_name("stereo|left|right")
      ->transform(CLI::CheckedTransformer(choices).description(""));
  command
      .add_option(
          "--calibration", options.calibration,
          "Calibration, in place of the recording's own: EuRoC sensor.yaml, OpenCV or ROS YAML, Kalibr camchain")
      ->type_name("FILE");
  command
      .add_option("--fps", options.frame_rate_hz,
                  "Frame rate of images and videos, in place of the times in their names or of what the video says")
      ->type_name("HZ")
      ->check(CLI::Range(kLowestFrameRate, kHighestFrameRate).description(""));
}

}  // namespace byre::cli
