#pragma once

#include "byre/camera/live_cameras.h"

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace CLI {
class App;
class Option;
}  // namespace CLI

namespace byre::cli {

// Options of live cameras.
struct CameraOptions {
  std::vector<std::filesystem::path> devices;  // one device, or left and right
  bool side_by_side = false;
  VideoRequest request;
  double pair_limit_ms = 5.0;
  std::optional<double> exposure_limit_ms;

  LiveCameraOptions live() const;
  std::string name() const;  // such as "/dev/video0 and /dev/video2"
};

inline constexpr const char* kDevicesHelp =
    "Camera device (/dev/video0, /dev/v4l/by-id/...); two devices are the left and the right camera of a pair";

// --side-by-side, --size, --rate, --pixel-format, --pair-limit and --exposure-limit. They need the option of the
// devices, unless that is required. The options must outlive the parsing of the command line.
void declare_camera_options(CLI::App& command, CameraOptions& options, CLI::Option* devices);

}  // namespace byre::cli
