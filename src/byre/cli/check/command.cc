#include "byre/cli/commands.h"
#include "byre/cli/shared/arguments.h"
#include "byre/cli/shared/options.h"
#include "byre/cli/shared/progress.h"
#include "byre/features/image_threads.h"
#include "byre/io/recording/motion_files.h"
#include "byre/playback/report/recording_report.h"

#include <algorithm>
#include <iostream>
#include <memory>

#include <CLI/CLI.hpp>

namespace byre::cli {
namespace {

struct CheckOptions {
  std::filesystem::path recording;
  OpenOptions open;
  FrameRange range;
  int samples = 100;
  bool json = false;
};

constexpr const char* kCheckFooter = R"(Examples:
  byre check evening_round
  byre check evening_round --calibration calibration.yaml --json

Reads a sample of the frames, in a few seconds, and reports problems with remedies: frame rate and gaps; dark,
blurred or repeated images; left and right images that do not match; a calibration that is inaccurate or of other
cameras; faults of wheels, gyroscope and accelerometer (--gyroscope). "byre map" and "byre run" print the summary
when they start.

Exit codes: 0 no serious problem, 1 a serious problem must be solved first, 3 the recording cannot be read.)";

ExitCode run_check(const CheckOptions& options, std::ostream& result) {
  const auto recording = open_recording(options.recording, options.range, options.open);
  show_warnings(std::cerr, recording->warnings());
  limit_image_threads(1);
  const InterruptCatcher interrupt;
  const RecordingCheck check = check_recording(*recording, options.samples, [&] { return interrupt.caught(); });
  if (interrupt.caught()) return ExitCode::interrupted;
  std::vector<Finding> findings = findings_of(check);
  const std::vector<Finding> motion = motion_findings(
      *recording, [&](MotionSensor sensor) { return motion_source(options.recording, options.open, sensor); });
  findings.insert(findings.end(), motion.begin(), motion.end());
  const Report report = check_report(check, findings, options.recording.string());
  result << (options.json ? to_json(report) : to_text(report, false));
  return std::ranges::any_of(findings, &Finding::is_critical) ? ExitCode::failed : ExitCode::done;
}

}  // namespace

Action declare_check(CLI::App& command) {
  const auto options = std::make_shared<CheckOptions>();
  add_input(command, Input::recording, "RECORDING", options->recording, kRecordingHelp)->type_name("PATH")->required();
  command.add_option("--samples", options->samples, "Number of sampled places of the recording, two frames each")
      ->check(CLI::Range(1, 100'000))
      ->capture_default_str();
  declare_open_options(command, options->open);
  declare_frame_range(command, options->range);
  command.add_flag("--json", options->json, "Print the result as JSON");
  command.footer(kCheckFooter);
  return [options](std::ostream& result) { return run_check(*options, result); };
}

}  // namespace byre::cli
