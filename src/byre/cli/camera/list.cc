#include "byre/base/report_row.h"
#include "byre/camera/video_modes.h"
#include "byre/cli/camera/commands.h"
#include "byre/cli/shared/camera_options.h"
#include "byre/cli/shared/file_arguments.h"
#include "byre/input_error.h"

#include <memory>
#include <ostream>
#include <stdexcept>

#include <CLI/CLI.hpp>

namespace byre::cli {
namespace {

namespace fs = std::filesystem;

constexpr const char* kListFooter = R"(Examples:
  byre camera list
  byre camera list /dev/video0

Lists for each camera its name, its port, its names in /dev/v4l/by-id (stable across restarts), formats, sizes and
rates, and the meaning of its time stamps. Formats that byre does not read are marked. "byre camera show" measures
the actual frame rate and image quality.

Exit codes: 0 done, 1 no camera was found, 3 a given device is not a camera.)";

ExitCode list_named(const std::vector<fs::path>& devices, std::ostream& result) {
  for (const fs::path& device : devices) {
    result << describe_device(device, formats_of(VideoDescriptor(device), device.string()));
  }
  return ExitCode::done;
}

ExitCode list_all(std::ostream& result) {
  int found = 0;
  for (const fs::path& device : video_devices()) {
    try {
      const auto formats = formats_if_camera(device);
      if (!formats) continue;
      result << describe_device(device, *formats);
      ++found;
    } catch (const InputError& fault) {
      result << row("no access", fault.what());
    }
  }
  if (found == 0) throw std::runtime_error("no usable camera: none of /dev/video* is one");
  return ExitCode::done;
}

}  // namespace

Action declare_camera_list(CLI::App& command) {
  const auto named = std::make_shared<std::vector<fs::path>>();
  add_text(command, "DEVICE", *named, "Cameras to list (all)")->type_name("DEVICE");
  command.footer(kListFooter);
  return [named](std::ostream& result) { return named->empty() ? list_all(result) : list_named(*named, result); };
}

}  // namespace byre::cli
