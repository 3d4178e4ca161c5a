#include "byre/base/output_file.h"
#include "byre/base/report_row.h"
#include "byre/base/stopwatch.h"
#include "byre/calibration_file.h"
#include "byre/camera/camera_measure.h"
#include "byre/camera/capture_thread.h"
#include "byre/camera/record_run.h"
#include "byre/camera/still_image.h"
#include "byre/camera/video_modes.h"
#include "byre/cli/commands.h"
#include "byre/cli/shared/arguments.h"
#include "byre/cli/shared/camera_options.h"
#include "byre/cli/shared/progress.h"
#include "byre/image_condition.h"
#include "byre/input_error.h"

#include <iostream>
#include <memory>
#include <ostream>
#include <span>
#include <stdexcept>
#include <utility>

#include <CLI/CLI.hpp>
#include <fmt/core.h>

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

struct CameraShowOptions {
  CameraOptions cameras;
  double duration_s = 3.0;
  std::optional<std::filesystem::path> still;
};

constexpr const char* kShowFooter = R"(Examples:
  byre camera show /dev/video0
  byre camera show /dev/video0 -o still.png --size 1280x720 --rate 30
  byre camera show /dev/video0 /dev/video2 --duration 10 --exposure-limit 5

Measures for a few seconds: frame rate and its regularity, meaning of the time stamps, lost images, and of the newest
image brightness, contrast, sharpness and the number of corners per part of the image. Parts without corners do not
constrain poses. For two cameras it reports the time difference of their images.

Exit codes: 0 done, 1 no image arrived, 3 the camera cannot be used.)";

std::string describe_intervals(const std::vector<Timestamp>& stamps) {
  const auto intervals = measure_intervals(stamps);
  if (!intervals) return fmt::format("{} frames: too few to measure a rate", stamps.size());
  return fmt::format("{:.2f} Hz over {} frames; intervals deviate by {:.2f} ms, the longest is {:.1f} ms",
                     intervals->rate_hz, stamps.size(), 1e3 * intervals->deviation_s, 1e3 * intervals->longest_s);
}

std::string describe_image(const char* name, const Image& image) {
  const ImageCondition condition = measure_condition(image);
  const ImageFault fault = fault_of(condition, {});
  std::string text = row(
      name, fmt::format("brightness {:.0f} and contrast {:.0f} grey values, sharpness {:.2f}, {:.0f} % black or white",
                        condition.brightness, condition.contrast, condition.sharpness, 100.0 * condition.clipped) +
                (fault == ImageFault::none ? "" : "; " + std::string(to_string(fault))));
  const CornerGrid grid = count_corners(image);
  text += row("corners", fmt::format("{}; {} of {} parts without corners:", grid.total(), grid.empty_cells(),
                                     static_cast<int>(grid.corners.size())));
  for (int y = 0; y < CornerGrid::kRows; ++y) {
    std::string line;
    for (int x = 0; x < CornerGrid::kColumns; ++x) {
      line += fmt::format("{:6}", grid.corners[static_cast<std::size_t>(y * CornerGrid::kColumns + x)]);
    }
    text += row("", line);
  }
  return text;
}

// Stamps of the images received, and the newest images.
std::pair<std::vector<Timestamp>, std::optional<ImageFrame>> look(CaptureThread& capture, double duration_s,
                                                                  const InterruptCatcher& interrupt) {
  std::vector<Timestamp> stamps;
  std::optional<ImageFrame> newest;
  const Stopwatch watch;
  while (!interrupt.caught() && watch.seconds() < duration_s) {
    auto frame = capture.next(std::chrono::milliseconds(50));
    for (const std::string& note : capture.take_notes()) show_warnings(std::cerr, {note});
    if (!frame) continue;
    stamps.push_back(frame->time);
    newest = std::move(frame);
  }
  capture.stop();
  return {std::move(stamps), std::move(newest)};
}

ExitCode run_show(const CameraShowOptions& options, std::ostream& result) {
  const InterruptCatcher interrupt;
  CaptureThread capture(options.cameras.live(), FrameRetention::all);
  const auto [stamps, newest] = look(capture, options.duration_s, interrupt);
  result << to_text(capture.report());
  if (!newest) {
    if (interrupt.caught()) return ExitCode::interrupted;
    throw std::runtime_error(options.cameras.name() + " delivered no image");
  }
  result << row("rate", describe_intervals(stamps));
  result << describe_image(newest->right ? "left" : "image", newest->left);
  if (newest->right) result << describe_image("right", *newest->right);
  if (options.still) {
    const ImageFrame& frame = *newest;
    const std::vector<std::uint8_t> png = png_of(frame.right ? side_by_side(frame.left, *frame.right) : frame.left);
    write_atomically(*options.still, std::as_bytes(std::span(png)));
    result << row("written", options.still->string());
  }
  return interrupt.caught() ? ExitCode::interrupted : ExitCode::done;
}

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

Action declare_camera_list(CLI::App& command) {
  const auto named = std::make_shared<std::vector<fs::path>>();
  add_text(command, "DEVICE", *named, "Cameras to list (all)")->type_name("DEVICE");
  command.footer(kListFooter);
  return [named](std::ostream& result) { return named->empty() ? list_all(result) : list_named(*named, result); };
}

Action declare_camera_show(CLI::App& command) {
  const auto options = std::make_shared<CameraShowOptions>();
  CLI::Option* const devices =
      add_text(command, "DEVICE", options->cameras.devices, kDevicesHelp)->type_name("DEVICE")->required();
  add_output(command, Output::picture, "-o,--output", options->still, "Newest image; of a pair both, side by side")
      ->type_name("FILE.png");
  command.add_option("--duration", options->duration_s, "Duration of the measurement")
      ->type_name("SECONDS")
      ->check(between(0.1, 1e6))
      ->capture_default_str();
  declare_camera_options(command, options->cameras, devices);
  check_when_parsed(command, [options] {
    if (!options->still || options->still->extension() == ".png") return;
    throw CLI::ValidationError("--output", "must end in .png");
  });
  command.footer(kShowFooter);
  return [options](std::ostream& result) { return run_show(*options, result); };
}

Action declare_camera_record(CLI::App& command) {
  const auto options = std::make_shared<RecordOptions>();
  CLI::Option* const devices =
      add_text(command, "DEVICE", options->cameras.devices, kDevicesHelp)->type_name("DEVICE")->required();
  add_output(command, Output::recording, "-o,--output", options->output,
             "Recording: an MCAP file if the name ends in .mcap, else the folder of a EuRoC recording")
      ->type_name("FOLDER|FILE")
      ->required();
  add_input(command, Input::file, "--calibration", options->calibration, "Calibration to store with the images");
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

}  // namespace

Action declare_camera(CLI::App& command) {
  return declare_subcommands(
      command, {{"list", "List cameras and their formats", declare_camera_list},
                {"show", "Examine a camera: frame rate, time stamps, brightness, corners", declare_camera_show},
                {"record", "Record cameras as a EuRoC folder or an MCAP file", declare_camera_record}});
}

}  // namespace byre::cli
