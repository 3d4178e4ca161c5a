#include "byre/base/report_row.h"
#include "byre/base/stopwatch.h"
#include "byre/calibration_file.h"
#include "byre/camera/capture_thread.h"
#include "byre/camera/record_run.h"
#include "byre/cli/camera/commands.h"
#include "byre/cli/shared/camera_options.h"
#include "byre/cli/shared/file_arguments.h"
#include "byre/cli/shared/interrupt.h"
#include "byre/cli/shared/number_check.h"
#include "byre/cli/shared/warnings.h"
#include "byre/input_error.h"

#include <iostream>
#include <memory>
#include <stdexcept>

#include <CLI/CLI.hpp>
#include <fmt/core.h>

namespace byre::cli {
namespace {

namespace fs = std::filesystem;

struct RecordOptions {
  CameraOptions cameras;
  fs::path output;
  std::optional<fs::path> calibration;
  RecordLimits limits;
  bool quiet = false;
};

constexpr const char* kRecordFooter = R"(Examples:
  byre camera record /dev/video0 -o walk --calibration camera.yaml --duration 60
  byre camera record /dev/video0 /dev/video2 -o walk.mcap --calibration camchain.yaml --size 640x480 --rate 30
  byre camera record /dev/video0 --side-by-side --size 2560x720 -o walk --calibration camchain.yaml --exposure-limit 5
  byre map walk -o barn.byre

Images are written as 8-bit grey, with the driver's time stamps, in UTC. Without --calibration the recording contains
none; "byre map walk --calibration FILE" takes one later. Ctrl-C ends the recording; earlier frames are stored,
however the program ends (in an MCAP file, all but the last second). Lost images are reported.

Exit codes: 0 done, 1 no frame arrived, 3 a camera or a file cannot be used; 130 ended by Ctrl-C, which is equivalent
to 0.)";

// Opens the cameras, with the image size of the calibration if there is one.
std::unique_ptr<CaptureThread> open_cameras(const RecordOptions& options,
                                            const std::optional<Calibration>& calibration) {
  LiveCameraOptions live = options.cameras.live();
  if (calibration) request_calibrated_size(*calibration, live);
  auto capture = std::make_unique<CaptureThread>(live, FrameRetention::all);
  if (calibration) require_fit(*calibration, *capture, options.calibration->string());
  return capture;
}

std::string describe_frames(const RecordedFrames& recorded, bool has_right) {
  std::string text = fmt::format("{}", recorded.frames);
  if (has_right) text += fmt::format(", {} of them pairs", recorded.with_right);
  if (recorded.first) {
    const double seconds = to_seconds(*recorded.last - *recorded.first);
    text += fmt::format(", {:.1f} s", seconds);
    if (seconds > 0.0) text += fmt::format(", {:.2f} Hz", (recorded.frames - 1) / seconds);
  }
  if (recorded.skipped > 0) text += fmt::format("; {} could not be written in time", recorded.skipped);
  return text;
}

ExitCode run_record(const RecordOptions& options, std::ostream& result) {
  const InterruptCatcher interrupt;
  std::optional<Calibration> calibration;
  if (options.calibration) calibration = read_calibration(*options.calibration);
  const std::unique_ptr<CaptureThread> capture = open_cameras(options, calibration);
  const RecordedCameras cameras{capture->has_right(), capture->rate_hz(), calibration};
  const std::unique_ptr<FrameSink> sink = open_sink(options.output, cameras);
  const Stopwatch watch;
  double shown_s = 0.0;
  RecordHooks hooks;
  hooks.should_stop = [&] { return interrupt.caught(); };
  hooks.on_note = [](const std::string& note) { show_warnings(std::cerr, {note}); };
  hooks.after_frame = [&](int frames, const ImageFrame&) {
    constexpr double kInterval_s = 5.0;
    if (options.quiet || (frames > 1 && watch.seconds() - shown_s < kInterval_s)) return;
    shown_s = watch.seconds();
    std::cerr << fmt::format("{} frames after {:.0f} s", frames, shown_s) << std::endl;
  };
  const RecordedFrames recorded = record_frames(*capture, *sink, options.limits, hooks);
  result << row("recorded", options.output.string()) << row("frames", describe_frames(recorded, cameras.has_right))
         << to_text(recorded.cameras);
  if (interrupt.caught()) return ExitCode::interrupted;
  if (recorded.frames == 0) throw std::runtime_error(options.cameras.name() + " delivered no frame");
  return ExitCode::done;
}

}  // namespace

Action declare_camera_record(CLI::App& command) {
  const auto options = std::make_shared<RecordOptions>();
  CLI::Option* const devices =
      add_text(command, "DEVICE", options->cameras.devices, kDevicesHelp)->type_name("DEVICE")->required();
  add_output(command, Output::recording, "-o,--output", options->output,
             "Recording: an MCAP file if the name ends in .mcap, else the folder of a EuRoC recording")
      ->type_name("FOLDER|FILE")
      ->required();
  add_input(command, Input::file, "--calibration", options->calibration, "Calibration to store with the images")
      ->type_name("FILE");
  command.add_option("--duration", options->limits.duration_s, "End after this time")
      ->type_name("SECONDS")
      ->check(between(0.01, 1e9));
  command.add_option("--frames", options->limits.frames, "End after this number of frames")
      ->type_name("N")
      ->check(between(1, 1'000'000'000));
  declare_camera_options(command, options->cameras, devices);
  command.add_flag("--quiet", options->quiet, "Show no progress");
  command.footer(kRecordFooter);
  return [options](std::ostream& result) { return run_record(*options, result); };
}

}  // namespace byre::cli
