#include "byre/base/output_file.h"
#include "byre/calibration_file.h"
#include "byre/cli/commands.h"
#include "byre/cli/shared/arguments.h"
#include "byre/cli/shared/map_extrinsics.h"
#include "byre/cli/shared/options.h"
#include "byre/cli/shared/progress.h"
#include "byre/extrinsics_file.h"
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
  std::optional<fs::path> extrinsics;
  MethodArguments method;
  bool json = false;
  bool quiet = false;
};

constexpr const char* kCalibrateFooter = R"(Examples:
  byre calibrate evening_round -o calibration.yaml
  byre map evening_round --calibration calibration.yaml -o barn.byre
  byre calibrate evening_round -o calibration.yaml --extrinsics robot.yaml

Maps the recording, and refines its calibration (or --calibration) by image measurements: focal lengths, principal
points, distortion, rotation of the right camera. The report gives each parameter with its standard deviation before
and after; parameters that the motion does not constrain stay as given. Rotate the camera about all axes, and view
near and far objects, for a minute or two. Images do not constrain the length of the baseline: "byre register
--fix-scale" takes it from a floor plan. "byre map" refines the calibration of each recording likewise, and stores it
in the map.

--extrinsics writes the pose of the left or only camera on the robot's base, as wheel odometry and images determine it;
drive bends to both sides. The height of the camera is not estimated.)";

bool has_wheels(const MotionSamples& motion) {
  return !motion.wheels.empty() || !motion.velocities.empty();
}

// Throws InputError if the recording cannot determine the extrinsics that are to be written.
void require_extrinsics(const CalibrateOptions& options, const Recording& recording) {
  if (!options.extrinsics) return;
  require_writable(*options.extrinsics);
  if (options.open.camera == CameraChoice::right) {
    throw InputError(options.extrinsics->string(),
                     "takes the pose of the left camera, and --camera right uses the other one",
                     "leave out --extrinsics, or use --camera left");
  }
  if (!has_wheels(recording.motion())) {
    throw InputError(options.recording.string(), "has no wheel odometry, which extrinsics are estimated from",
                     "give it with --wheels or --wheels-topic, or leave out --extrinsics");
  }
}

Report calibrate_report(const CalibrateOptions& options, const RefinedCalibration& refined) {
  Report report{{{"program", "byre calibrate"},
                 {"version", BYRE_VERSION},
                 {"recording", options.recording.string()},
                 {"written", options.output.string()},
                 {"calibration", calibration_json(refined)}}};
  report.row("recording", "{recording}");
  add_calibration(refined, report);
  report.row("written", "{written}");
  if (options.extrinsics) {
    report.figures["extrinsics_file"] = options.extrinsics->string();
    report.row("extrinsics", "{extrinsics_file}; the height of the camera is not estimated");
  }
  report.conclude("Next: byre map {recording} --calibration {written} -o MAP.byre");
  return report;
}

// Throws InputError if the drive did not determine them.
void write_estimated_extrinsics(const CalibrateOptions& options, const RunResult& run) {
  if (!run.motion.calibration_to_store.wheels) {
    throw InputError(options.recording.string(), "turns too little to determine the extrinsics",
                     "record a minute or more with bends to both sides; the calibration is written");
  }
  write_extrinsics(*options.extrinsics, extrinsics_of(run.stored, options.recording.string()));
}

ExitCode run_calibrate(const CalibrateOptions& options, std::ostream& result) {
  require_writable(options.output);
  const auto [recording, is_metric, body_from_camera] =
      open_scaled(options.recording, options.range, options.open, false);
  require_extrinsics(options, *recording);
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
  if (options.extrinsics) write_estimated_extrinsics(options, run);
  const Report report = calibrate_report(options, *run.calibration);
  result << (options.json ? to_json(report) : to_text(report, false));
  return ExitCode::done;
}

}  // namespace

Action declare_calibrate(CLI::App& command) {
  const auto options = std::make_shared<CalibrateOptions>();
  add_input(command, Input::recording, "RECORDING", options->recording, kRecordingHelp)->type_name("PATH")->required();
  add_output(command, Output::calibration, "-o,--output", options->output, "Calibration file (Kalibr format)")
      ->type_name("YAML")
      ->required();
  add_output(command, Output::calibration, "--extrinsics", options->extrinsics,
             "Also write the extrinsics of the robot, estimated from wheel odometry. YAML format");
  declare_open_options(command, options->open);
  declare_frame_range(command, options->range);
  declare_options_file(command, options->method);
  command.add_flag("--json", options->json, "Print the result as JSON");
  command.add_flag("--quiet", options->quiet, "Show no progress");
  command.footer(kCalibrateFooter);
  return [options](std::ostream& result) { return run_calibrate(*options, result); };
}

}  // namespace byre::cli
