#include "byre/cli/camera/commands.h"

#include <array>
#include <memory>

#include <CLI/CLI.hpp>

namespace byre::cli {
namespace {

struct CameraCommand {
  const char* name;
  const char* summary;
  Action (*declare)(CLI::App& command);
};

constexpr std::array kCameraCommands = {
    CameraCommand{"list", "List cameras and their formats", declare_camera_list},
    CameraCommand{"show", "Examine a camera: frame rate, time stamps, brightness, corners", declare_camera_show},
    CameraCommand{"record", "Record cameras as a EuRoC folder or an MCAP file", declare_camera_record},
};

}  // namespace

Action declare_camera(CLI::App& command) {
  const auto chosen = std::make_shared<Action>();
  command.require_subcommand(1);
  for (const CameraCommand& each : kCameraCommands) {
    CLI::App* const declared = command.add_subcommand(each.name, each.summary);
    declared->callback([chosen, run = each.declare(*declared)] { *chosen = run; });
  }
  return [chosen](std::ostream& result) { return (*chosen)(result); };
}

}  // namespace byre::cli
