#include "byre/base/output_file.h"
#include "byre/benchmark/plots.h"
#include "byre/cli/commands.h"
#include "byre/cli/shared/arguments.h"
#include "byre/cli/shared/options.h"
#include "byre/input_error.h"
#include "byre/io/recording/trajectory_input.h"
#include "byre/playback/report/evaluation_report.h"
#include "byre/recording.h"
#include "byre/trajectory_file.h"

#include <filesystem>
#include <map>
#include <memory>
#include <ostream>
#include <stdexcept>

#include <CLI/CLI.hpp>

namespace byre::cli {
namespace {

namespace fs = std::filesystem;

struct EvaluateOptions {
  fs::path estimate;
  fs::path truth;
  std::optional<fs::path> times;
  std::optional<fs::path> frames_of;
  OpenOptions open;
  std::optional<fs::path> aligned;
  TrajectoryFormat format = TrajectoryFormat::tum;  // format of the aligned trajectory written
  std::optional<fs::path> plot;
  EvaluationProtocol protocol;
  double time_offset_s = 0.0;
  double max_gap_s = to_seconds(AssociationOptions{}.max_gap);
  bool json = false;
  bool is_of_camera = false;
};

constexpr const char* kEvaluateFooter = R"(Examples:
  byre evaluate --estimate out.txt --truth MH_01_easy --frames-of MH_01_easy --label final
  byre evaluate --estimate out.txt --truth MH_01_easy --time-offset -0.0075
  byre evaluate --estimate out.txt --truth kitti/poses/00.txt --times kitti/sequences/00/times.txt
  byre evaluate --estimate out.txt --truth MH_01_easy --align origin --plot errors.svg
  byre evaluate --estimate mono.txt --truth MH_01_easy --frames-of MH_01_easy --camera left --estimate-of camera --alignment sim3

Estimate and truth must be of the same body: EuRoC's truth is of the IMU, KITTI's of the left camera. A monocular
trajectory of byre is of the camera, with unknown scale: --estimate-of camera converts the truth to the camera by the
calibration of --frames-of, and --alignment sim3 estimates the scale. Segments are those of KITTI's development kit:
the error of the motion along 100 to 800 m of the true path, in per cent and degrees per metre.)";

// True poses of the estimated frame: body or camera.
Trajectory true_path(const EvaluateOptions& options) {
  Trajectory truth = load_truth(options.truth, options.times);
  if (!options.is_of_camera) return truth;
  const Pose body_from_camera = open_recording(*options.frames_of, {}, options.open)->calibration().body_from_left;
  for (StampedPose& sample : truth) sample.world_from_body = sample.world_from_body * body_from_camera;
  return truth;
}

std::optional<ExpectedFrames> expected_frames(const EvaluateOptions& options) {
  if (options.frames_of) {
    const std::unique_ptr<Recording> recording = open_recording(*options.frames_of, {}, options.open);
    return ExpectedFrames{recording->times(), "frames of " + options.frames_of->string()};
  }
  if (options.times) return ExpectedFrames{read_times(*options.times), "times in " + options.times->string()};
  return std::nullopt;
}

std::string span_of(const Trajectory& trajectory) {
  return std::to_string(to_seconds(trajectory.front().time)) + " to " +
         std::to_string(to_seconds(trajectory.back().time)) + " s";
}

Trajectory aligned_trajectory(const Trajectory& estimate, const EvaluationReport& report) {
  if (!report.ate) throw std::runtime_error("the estimate cannot be aligned, so it is not written");
  Trajectory result;
  for (const StampedPose& sample : estimate) {
    result.push_back({sample.time, aligned(report.ate->truth_from_estimate, sample.world_from_body)});
  }
  return result;
}

bool is_of_kitti(const fs::path& truth) {
  const std::optional<fs::path> file = fs::is_directory(truth) ? find_ground_truth(truth) : truth;
  return file && !fs::is_directory(*file) && guess_trajectory_format(*file) == TrajectoryFormat::kitti;
}

void write_plot(const EvaluateOptions& options, const EvaluationReport& report, const Trajectory& estimate,
                const Trajectory& truth) {
  if (!report.ate) throw std::runtime_error("the estimate cannot be aligned, so it is not drawn");
  write_atomically(*options.plot, evaluation_plot(report, estimate, truth, is_of_kitti(options.truth)));
}

void run_evaluate(const EvaluateOptions& options, std::ostream& result) {
  if (options.aligned) require_writable(*options.aligned);
  const Trajectory estimate = load_trajectory(options.estimate, options.times);
  const Trajectory truth = true_path(options);
  EvaluationProtocol protocol = options.protocol;
  protocol.association.time_offset = from_seconds(options.time_offset_s);
  protocol.association.max_gap = from_seconds(options.max_gap_s);
  const std::optional<EvaluationReport> report = evaluate(estimate, truth, protocol, expected_frames(options));
  if (!report) {
    throw InputError(options.estimate.string(), "no pose of the estimate has truth at its time",
                     "the estimate is from " + span_of(estimate) + ", the truth from " + span_of(truth));
  }
  if (options.aligned) write_trajectory(aligned_trajectory(estimate, *report), *options.aligned, options.format);
  if (options.plot) write_plot(options, *report, estimate, truth);
  const std::string estimated = options.estimate.string(), true_one = options.truth.string();
  const Report printed = evaluation_report(*report, estimated, true_one);
  result << (options.json ? to_json(printed) : printed.text);
}

void declare_inputs(CLI::App& command, EvaluateOptions& options) {
  add_input(command, Input::recording, "--estimate", options.estimate,
            "Estimated trajectory: TUM, EuRoC csv, or KITTI with --times")
      ->required();
  add_input(command, Input::recording, "--truth", options.truth,
            "True trajectory in one of these formats, or a recording with truth")
      ->type_name("FILE|FOLDER")
      ->required();
  add_input(command, Input::file, "--times", options.times,
            "Times of KITTI poses, and of the frames counted for coverage");
  CLI::Option* const frames_of = add_input(command, Input::recording, "--frames-of", options.frames_of,
                                           "Recording whose frames are counted for coverage")
                                     ->type_name("FOLDER|VIDEO|BAG");
  const std::map<std::string, bool> movers = {{"body", false}, {"camera", true}};
  command
      .add_option("--estimate-of", options.is_of_camera,
                  "Path of the estimate, of body or camera (body); the truth is of the body")
      ->type_name("body|camera")
      ->transform(one_of(movers))
      ->needs(frames_of);
  declare_open_options(command, options.open);
}

void declare_protocol(CLI::App& command, EvaluateOptions& options) {
  const std::map<std::string, PoseAlignment> alignments = {{"se3", PoseAlignment::se3},
                                                           {"sim3", PoseAlignment::sim3},
                                                           {"origin", PoseAlignment::origin},
                                                           {"none", PoseAlignment::none}};
  command
      .add_option("--alignment,--align", options.protocol.alignment,
                  "se3 (default), sim3 for monocular estimates, origin: first pose equals the true one, none: poses in "
                  "the frame of an aligned map")
      ->type_name("se3|sim3|origin|none")
      ->transform(one_of(alignments));
  command.add_option("--label", options.protocol.label, "Label of the estimate in the report's header")
      ->type_name("causal|final")
      ->transform(one_of<std::string>({{"causal", "causal"}, {"final", "final"}}));
  command.add_option("--time-offset", options.time_offset_s, "Added to the truth's time stamps (EuRoC MH_01: -0.0075)")
      ->type_name("SECONDS")
      ->check(between(-1e6, 1e6));
  command.add_option("--max-gap", options.max_gap_s, "Longest interpolated gap in the truth")
      ->type_name("SECONDS")
      ->check(between(0.0, 1e6))
      ->capture_default_str();
}

}  // namespace

Action declare_evaluate(CLI::App& command) {
  const auto options = std::make_shared<EvaluateOptions>();
  declare_inputs(command, *options);
  declare_protocol(command, *options);
  command.add_flag("--json", options->json, "Print the report as JSON");
  add_output(command, Output::trajectory, "--aligned", options->aligned,
             "Also write all poses of the estimate, aligned to the truth");
  declare_trajectory_format(command, options->format);
  add_output(command, Output::picture, "--plot", options->plot,
             "Also draw both paths from above and the error over time, as SVG");
  command.footer(kEvaluateFooter);
  return [options](std::ostream& result) {
    run_evaluate(*options, result);
    return ExitCode::done;
  };
}

}  // namespace byre::cli
