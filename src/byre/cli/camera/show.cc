#include "byre/base/output_file.h"
#include "byre/base/report_row.h"
#include "byre/base/stopwatch.h"
#include "byre/camera/camera_measure.h"
#include "byre/camera/capture_thread.h"
#include "byre/camera/still_image.h"
#include "byre/cli/camera/commands.h"
#include "byre/cli/shared/camera_options.h"
#include "byre/cli/shared/file_arguments.h"
#include "byre/cli/shared/interrupt.h"
#include "byre/cli/shared/number_check.h"
#include "byre/cli/shared/warnings.h"
#include "byre/image_condition.h"

#include <iostream>
#include <memory>
#include <span>
#include <stdexcept>

#include <CLI/CLI.hpp>
#include <fmt/core.h>

namespace byre::cli {
namespace {

struct CameraShowOptions {
  CameraOptions cameras;
  double duration_s = 3.0;
  std::optional<std::filesystem::path> still;
};

// Images and stamps received.
struct Shown {
  std::vector<Timestamp> stamps;
  std::optional<ImageFrame> newest;
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

Shown look(CaptureThread& capture, double duration_s, const InterruptCatcher& interrupt) {
  Shown shown;
  const Stopwatch watch;
  while (!interrupt.caught() && watch.seconds() < duration_s) {
    auto frame = capture.next(std::chrono::milliseconds(50));
    for (const std::string& note : capture.take_notes()) show_warnings(std::cerr, {note});
    if (!frame) continue;
    shown.stamps.push_back(frame->time);
    shown.newest = std::move(frame);
  }
  capture.stop();
  return shown;
}

ExitCode run_show(const CameraShowOptions& options, std::ostream& result) {
  const InterruptCatcher interrupt;
  CaptureThread capture(options.cameras.live(), FrameRetention::all);
  const Shown shown = look(capture, options.duration_s, interrupt);
  result << to_text(capture.report());
  if (!shown.newest) {
    if (interrupt.caught()) return ExitCode::interrupted;
    throw std::runtime_error(options.cameras.name() + " delivered no image");
  }
  result << row("rate", describe_intervals(shown.stamps));
  result << describe_image(shown.newest->right ? "left" : "image", shown.newest->left);
  if (shown.newest->right) result << describe_image("right", *shown.newest->right);
  if (options.still) {
    const ImageFrame& frame = *shown.newest;
    const std::vector<std::uint8_t> png = png_of(frame.right ? side_by_side(frame.left, *frame.right) : frame.left);
    write_atomically(*options.still, std::as_bytes(std::span(png)));
    result << row("written", options.still->string());
  }
  return interrupt.caught() ? ExitCode::interrupted : ExitCode::done;
}

}  // namespace

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

}  // namespace byre::cli
