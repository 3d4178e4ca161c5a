#include "byre/base/output_file.h"
#include "byre/calibration_file.h"
#include "byre/cli/commands.h"
#include "byre/cli/shared/file_arguments.h"
#include "byre/cli/shared/interrupt.h"
#include "byre/cli/shared/method_arguments.h"
#include "byre/cli/shared/recording_options.h"
#include "byre/cli/shared/run_with_progress.h"
#include "byre/cli/shared/warnings.h"
#include "byre/features/image_threads.h"
#include "byre/input_error.h"
#include "byre/playback/report/calibration_report.h"
#include "byre/playback/scaled_recording.h"
#include "byre/slam/system/option_table.h"

#include <iostream>
#include <memory>
#include <optional>

#include <CLI/CLI.hpp>

namespace byre::cli {
namespace {

namespace fs = std::filesystem;

struct CalibrateOptions {
  fs::path recording;
  OpenOptions open;
  FrameRange range;
  fs::path output;
  MethodArguments method;
  bool json = false;
  bool quiet = false;
};

constexpr const char* kCalibrateFooter = R"(Examples:
  byre calibrate evening_round -o calibration.yaml
  byre map evening_round --calibration calibration.yaml -o barn.byre

Maps the recording, and refines its calibration (or --calibration) by image measurements: focal lengths, principal
points, distortion, rotation of the right camera. The report gives each parameter with its standard deviation before
and after; parameters that the motion does not constrain stay as given. Rotate the camera about all axes, and view
near and far objects, for a minute or two. Images do not constrain the length of the baseline: "byre register
--fix-scale" takes it from a floor plan. "byre map" refines the calibration of each recording likewise, and stores it
in the map.)";

Report calibrate_report(const CalibrateOptions& options, const RefinedCalibration& refined) {
  Report report{{{"program", "byre calibrate"},
                 {"version", BYRE_VERSION},
                 {"recording", options.recording.string()},
                 {"written", options.output.string()},
                 {"calibration", calibration_json(refined)}}};
  report.row("recording", "{recording}");
  add_calibration(refined, report);
  report.row("written", "{written}");
  return report;
}

ExitCode run_calibrate(const CalibrateOptions& options, std::ostream& result) {
  require_writable(options.output);
  const auto [recording, is_metric, body_from_camera] =
      open_scaled(options.recording, options.range, options.open, false);
  if (!options.quiet) show_warnings(std::cerr, recording->warnings());
  SlamOptions slam_settings = slam_options(options.method.options());
  slam_settings.baseline = options.open.baseline;
  Slam slam = Slam::mapping(recording->calibration(), slam_settings);
  limit_image_threads(1);
  const InterruptCatcher interrupt;
  const RunResult run = play_with_progress(slam, *recording, {}, interrupt, options.quiet);
  if (interrupt.caught()) return ExitCode::interrupted;
  if (!run.calibration) {
    throw InputError(options.recording.string(), "shows too little to calibrate its cameras",
                     "record a minute or more of motion at a place with texture");
  }
  if (const auto warning = calibration_warning(run.calibration, run.row_error)) show_warnings(std::cerr, {*warning});
  Calibration calibration = run.calibration->calibration;
  if (!is_metric) calibration.body_from_left = body_from_camera;
  write_atomically(options.output, write_calibration(calibration));
  const Report report = calibrate_report(options, *run.calibration);
  result << (options.json ? to_json(report) : report.text);
  return ExitCode::done;
}

}  // namespace

Action declare_calibrate(CLI::App& command) {
  const auto options = std::make_shared<CalibrateOptions>();
  add_input(command, Input::recording, "RECORDING", options->recording, kRecordingHelp)->type_name("PATH")->required();
  add_output(command, Output::calibration, "-o,--output", options->output, "Calibration file (Kalibr format)")
      ->type_name("YAML")
      ->required();
  declare_open_options(command, options->open);
  declare_frame_range(command, options->range);
  declare_options_file(command, options->method);
  command.add_flag("--json", options->json, "Print the result as JSON");
  command.add_flag("--quiet", options->quiet, "Show no progress");
  command.footer(kCalibrateFooter);
  return [options](std::ostream& result) { return run_calibrate(*options, result); };
}

}  // namespace byre::cli
