#include "byre/cli/shared/live_input.h"

#include "byre/base/report_row.h"
#include "byre/camera/live_frames.h"
#include "byre/cli/shared/arguments.h"
#include "byre/cli/shared/camera_options.h"

#include <utility>

#include <CLI/CLI.hpp>
#include <fmt/core.h>

namespace byre::cli {

bool LiveOptions::is_wanted() const {
  return cameras != nullptr && !cameras->devices.empty();
}

std::string LiveOptions::name() const {
  return cameras->name();
}

void declare_live_options(CLI::App& command, LiveOptions& options, MethodArguments& arguments) {
  options.cameras = std::make_shared<CameraOptions>();
  CLI::Option* const live =
      add_text(command, "--live", options.cameras->devices,
               std::string("Live cameras instead of a recording. ") + kDevicesHelp + ". Needs --calibration")
          ->type_name("DEVICE");
  live->each([&arguments](const std::string&) { arguments.is_live = true; });
  for (const char* const name :
       {"RECORDING", "--camera", "--fps", "--left", "--right", "--start", "--end", "--frames", "--stride", "--wheels",
        "--no-wheels", "--gyroscope", "--wheels-topic", "--imu-topic", "--pair-tolerance"}) {
    live->excludes(command.get_option(name));
  }
  command.add_option("--duration", options.duration_s, "End this long after the first frame (default: Ctrl-C)")
      ->type_name("SECONDS")
      ->check(between(0.01, 1e9))
      ->needs(live);
  declare_camera_options(command, *options.cameras, live);
}

LiveInput open_live(const LiveOptions& options, const Calibration& calibration, const std::string& calibration_file,
                    std::function<void(const std::string& note)> on_note) {
  auto frames = std::make_unique<LiveFrames>(options.cameras->live(), calibration, calibration_file, options.duration_s,
                                             std::move(on_note));
  LiveFrames* const live = frames.get();
  return {std::move(frames), [live] {
            const LiveCameraReport cameras = live->finish();
            return to_text(cameras) + row("skipped", fmt::format("{} frames, replaced by newer ones", live->skipped()));
          }};
}

}  // namespace byre::cli
