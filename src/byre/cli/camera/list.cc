#include "byre/camera/video_devices.h"
#include "byre/cli/camera/commands.h"
#include "byre/cli/shared/camera_options.h"
#include "byre/cli/shared/file_arguments.h"
#include "byre/input/report_row.h"
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

Tells of each camera its name, where it is plugged in, its names in /dev/v4l/by-id (the same after each start), and its
formats, sizes and rates, and which moment its stamps are of. Formats that byre does not read are marked. "byre camera
show" tells what a camera really gives.

Exit codes: 0 done, 1 no camera was found, 3 a device that was named is no camera.)";

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
  if (found == 0) throw std::runtime_error("there is no camera that can be used: none of /dev/video* is one");
  return ExitCode::done;
}

}  // namespace

Action declare_camera_list(CLI::App& command) {
  const auto named = std::make_shared<std::vector<fs::path>>();
  add_text(command, "DEVICE", *named, "Cameras to tell of (all there are)")->type_name("DEVICE");
  command.footer(kListFooter);
  return [named](std::ostream& result) { return named->empty() ? list_all(result) : list_named(*named, result); };
}

}  // namespace byre::cli
