#include "byre/base/output_file.h"
#include "byre/base/report_row.h"
#include "byre/base/stopwatch.h"
#include "byre/cli/commands.h"
#include "byre/cli/shared/arguments.h"
#include "byre/cli/shared/options.h"
#include "byre/cli/shared/outputs.h"
#include "byre/cli/shared/progress.h"
#include "byre/cli/shared/run_input.h"
#include "byre/features/image_threads.h"
#include "byre/io/recording/trajectory_input.h"
#include "byre/playback/autosave.h"
#include "byre/playback/map_from_poses_run.h"
#include "byre/playback/play.h"
#include "byre/playback/report/calibration_report.h"
#include "byre/playback/report/run_record.h"
#include "byre/playback/report/run_report.h"
#include "byre/playback/scaled_recording.h"
#include "byre/slam/system/option_table.h"
#include "byre/slam/system/stored_map.h"
#include "byre/tag_file.h"

#include <filesystem>
#include <iosfwd>
#include <iostream>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/core.h>

namespace byre::cli {
namespace {

namespace fs = std::filesystem;

// Options of "byre map".
struct MapOptions : RunInputOptions {
  std::optional<fs::path> map;
  std::optional<fs::path> given_poses;  // given trajectory of the recording; empty: it is estimated
  std::optional<fs::path> extended;     // map to extend
  std::optional<fs::path> tags;         // file of AprilTags
  std::optional<double> autosave_s;
  std::string site;

  std::vector<fs::path> outputs() const { return given_paths({map, trajectory, causal_trajectory, stats, record}); }
};

constexpr const char* kMapFooter = R"(Examples:
  byre map MH_01_easy -o barn.byre
  byre map MH_01_easy -o barn.byre --trajectory out.txt --site "Barn 2"
  byre map kitti/sequences/00 --trajectory out.txt --causal-trajectory causal.txt --stats stats.json
  byre map MH_02_easy --extend barn.byre -o barn2.byre
  byre map MH_01_easy -o barn.byre --pace live --autosave 60
  byre map MH_01_easy --trajectory out.txt --start 10 --end 25.5 --stride 2
  byre map MH_01_easy --trajectory out.txt --pace live --quiet
  byre map images --calibration camchain.yaml --fps 20 -o barn.byre
  byre map walk.bag --calibration camchain.yaml -o barn.byre
  byre map rosbag2_2026_11_20 --left /cam0/image_raw --right /cam1/image_raw -o barn.byre --record mapping.mcap
  byre map MH_01_easy --tags tags.yaml -o barn.byre
  byre map --live /dev/video0 /dev/video2 --calibration camchain.yaml -o barn.byre --duration 120

inline runs mapping between the frames, paced in parallel with reproducible results; both run as fast as they can.
live feeds the frames at their time stamps and drops none; of cameras (--live) it takes the newest frame.
Trajectories are of the body: EuRoC's is the IMU, KITTI's the left camera. After the last frame, finishing searches
for loops again, adjusts the whole map, and removes weak points and redundant keyframes; with --extend only in the
new part and its neighbourhood ("byre refine" does it for the whole map). Ctrl-C or SIGTERM stops after the current
frame, skips finishing and still writes all files, with exit code 130 or 143; "byre refine" finishes the map later. A
second signal ends the program at once.)";

void declare_files(CLI::App& command, MapOptions& options) {
  declare_recording_argument(command, options);
  add_output(command, Output::map, "-o,--output", options.map,
             "Map, for \"byre localise\", \"byre inspect\" and later missions");
  add_output(command, Output::trajectory, "--trajectory", options.trajectory,
             "Final poses: as corrected after the last frame");
  add_output(command, Output::trajectory, "--causal-trajectory", options.causal_trajectory,
             "Causal poses: as published with their frames");
  add_output(command, Output::json, "--stats", options.stats, "Times, counts and the report of every frame, as JSON");
}

void declare_map_content(CLI::App& command, MapOptions& options) {
  add_input(command, Input::recording, "--poses", options.given_poses,
            "Trajectory of given body poses, which are held fixed; every frame becomes a keyframe");
  add_input(command, Input::file, "--tags", options.tags,
            "AprilTags on the robot's way, for missions: YAML, see docs/how-to/use_apriltags.md");
  add_text(command, "--site", options.site, "Name of the building, stored in the map")->type_name("TEXT");
  add_input(command, Input::file, "--vocabulary", options.vocabulary,
            "Vocabulary of the map's words (the built-in one)");
}

void declare_building(CLI::App& command, MapOptions& options) {
  add_input(command, Input::file, "--extend", options.extended,
            "Extend this map: the recording is localised in it and adjusted together with its neighbourhood")
      ->type_name("MAP");
  command.add_option("--autosave", options.autosave_s, "Interval at which the map is saved during the run")
      ->type_name("SECONDS")
      ->check(between(0.1, 1e6));
  declare_method_flag(command, "--no-loops", "loops.close", "false", options.method,
                      "Disable place recognition and finishing; for comparison");
  declare_method_flag(command, "--no-pictures", "map.pictures", "false", options.method,
                      "Store no pictures of keyframes in the map, up to 12 kB each");
  declare_method_flag(command, "--no-self-calibration", "calibration.refine", "false", options.method,
                      "Use the given calibration unchanged, without refinement");
}

void require_consistent_extension(const MapOptions& options) {
  if (!options.extended) return;
  if (!options.map) throw CLI::ValidationError("--extend", "makes a new map: give a file for it (-o barn2.byre)");
  if (!options.method.options().close_loops) {
    throw CLI::ValidationError("--extend", "needs place recognition: leave out --no-loops, or set loops.close to true");
  }
}

void require_consistent(const MapOptions& options) {
  require_consistent_input(options);
  if (options.live.is_wanted() && options.given_poses) {
    throw CLI::ValidationError("--poses", "are of a recording, which excludes --live");
  }
  if (!options.map && !options.trajectory) {
    throw CLI::ValidationError("--output",
                               "give a file for the map (-o barn.byre), the trajectory (--trajectory), or both");
  }
  if (options.given_poses && !options.map) {
    throw CLI::ValidationError("--poses", "makes a map only: give a file for it (-o barn.byre)");
  }
  if (options.given_poses && (options.trajectory || options.causal_trajectory || options.stats || options.record)) {
    throw CLI::ValidationError("--poses",
                               "estimates no trajectory, so trajectories, statistics and records cannot be written");
  }
  if (options.given_poses && (options.extended || options.autosave_s || !options.method.options().close_loops)) {
    throw CLI::ValidationError("--poses", "excludes --extend, --autosave and --no-loops");
  }
  if (options.autosave_s && !options.map) {
    throw CLI::ValidationError("--autosave", "saves the map: give a file for it (-o barn.byre)");
  }
  require_consistent_extension(options);
}

PosedRun run_with_progress(Recording& recording, const MapOptions& options, const InterruptCatcher& interrupt) {
  Progress progress(std::cerr, progress_style(options.quiet), recording.size());
  const Stopwatch watch;
  PosedRunHooks hooks;
  hooks.should_stop = [&interrupt] { return interrupt.caught(); };
  hooks.after_frame = [&](int done) { progress.update(done, watch.seconds(), "poses given"); };
  PosedRun run =
      run_map_from_poses(recording, load_truth(*options.given_poses), options.method.options().extract, hooks);
  progress.close();
  return run;
}

std::string to_text(const PosedRun& run, const MapOptions& options) {
  std::string poses = "given by " + options.given_poses->string() + ", not estimated";
  if (run.without_pose > 0) poses += fmt::format("; {} frames without pose are skipped", run.without_pose);
  return row("recording", fmt::format("{}, {} frames", options.recording.string(), run.frames)) + row("poses", poses) +
         row("map", fmt::format("{} keyframes, {} points", run.map.keyframe_count(), run.map.point_count())) +
         row("written", options.map->string());
}

// "byre map --poses": map from externally estimated poses.
ExitCode run_posed_map(const MapOptions& options, std::ostream& result) {
  const Vocabulary vocabulary = open_vocabulary(options.vocabulary);
  const std::unique_ptr<Recording> recording = open_recording(options.recording, options.range, options.open);
  if (!options.quiet) show_warnings(std::cerr, recording->warnings());
  limit_image_threads(1);
  const InterruptCatcher interrupt;
  const PosedRun run = run_with_progress(*recording, options, interrupt);
  if (!options.quiet) show_warnings(std::cerr, run.warnings);

  StoredMap stored;
  stored.map = run.map;
  stored.recordings = {{source_name(options.recording),
                        recording->calibration(),
                        recording->times().front(),
                        recording->times().back(),
                        {}}};
  stored.pose_source = PoseSource::given;
  save_for_missions(std::move(stored), vocabulary, options.site, *options.map);
  result << to_text(run, options);
  if (interrupt.caught()) return ExitCode::interrupted;
  require_frames(run.unreadable, run.frames, run.warnings);
  return ExitCode::done;
}

RunResult play_and_autosave(Slam& slam, RunInput& input, const MapOptions& options, RunRecord& messages,
                            const InterruptCatcher& interrupt) {
  const SlamInputs& inputs = slam.impl().inputs();
  Autosave autosave(options.autosave_s.value_or(0.0), [&](StoredMap stored) {
    stored.map = offline_copy(std::move(stored.map));
    save_for_missions(std::move(stored), *inputs.vocabulary, inputs.site, *options.map);
  });
  PlayHooks hooks;
  if (messages.is_wanted()) hooks.on_frame = [&messages](const RunView& view) { messages.note(view); };
  hooks.after_frame = [&messages](int, const PlayedFrame& frame) {
    if (!frame.report) messages.note_unreadable(frame);
  };
  if (options.autosave_s) {
    hooks.on_map_update = [&autosave](const SlamImpl& now) {
      autosave.update(now.session().joined_online(), [&now] { return now.stored_metadata(); });
    };
  }
  RunResult run = input.play(slam, hooks, interrupt);
  autosave.finish();
  run.warnings.insert(run.warnings.end(), autosave.failures().begin(), autosave.failures().end());
  return run;
}

void write_results(const MapOptions& options, const RunResult& run, const Report& report, OutputWriter& outputs) {
  outputs.attempt(options.trajectory, run.final, options.trajectory_format);
  outputs.attempt(options.causal_trajectory, run.causal, options.trajectory_format);
  outputs.attempt([&] {
    if (options.stats) write_atomically(*options.stats, to_json(report, run));
  });
}

Slam make_slam(const MapOptions& options, const RunInput& input) {
  SlamOptions slam = options.slam(input.name());
  slam.site = options.site;
  if (options.tags) slam.tags = read_tags(*options.tags);
  return options.extended ? Slam::extending(input.calibration(), *options.extended, slam)
                          : Slam::mapping(input.calibration(), slam);
}

RunProtocol protocol_of(const MapOptions& options, const Slam& slam, const RunInput& input) {
  RunProtocol protocol;
  input.describe(protocol);
  protocol.options = slam.impl().options();
  if (options.extended) protocol.extended = options.extended->string();
  for (const SourceRecording& source : slam.impl().inputs().extended.recordings) {
    protocol.recordings.push_back(source.name);
  }
  protocol.recordings.push_back(slam.impl().inputs().recording);
  return protocol;
}

void conclude(const MapOptions& options, const RunResult& run, Report& report) {
  if (run.final.empty()) return;  // an error follows
  constexpr double kFew = 0.05;   // share of frames without a pose
  const std::string recording = options.recording.empty() ? "RECORDING" : options.recording.string();
  report.conclude(
      "[{?stopped_early}Stopped after {counts.frames} of {protocol.frames_in_range} frames."
      "|{?has_gaps}{missing*100:.0f} % of the frames have no pose; \"byre check {recording}\" lists problems."
      "|{?is_unscaled}Complete, but of arbitrary scale; \"byre scale\" sets it.|Complete.] "
      "Next: [byre run {recording} --map {map}|byre map {recording} -o MAP.byre, which saves the map]",
      {{"recording", recording},
       {"missing", 1.0 - report.figures["counts"]["coverage"].get<double>()},
       {"has_gaps", report.figures["counts"]["coverage"].get<double>() < 1.0 - kFew},
       {"is_unscaled", !run.is_metric},
       {"map", options.map ? nlohmann::ordered_json(options.map->string()) : nlohmann::ordered_json()}});
}

ExitCode run_map_command(MapOptions options, std::ostream& result) {
  for (const fs::path& output : options.outputs()) require_writable(output);
  if (options.given_poses) return run_posed_map(options, result);
  open_vocabulary(options.vocabulary);  // detects a missing vocabulary before the recording is opened
  RunInput input(options, options.extended.has_value());
  Slam slam = make_slam(options, input);
  RunProtocol protocol = protocol_of(options, slam, input);

  limit_image_threads(1);
  input.show_check();
  const InterruptCatcher interrupt;
  RunRecord messages(std::optional<McapWriter>(options.record), input.calibration(), options.record_images,
                     [](const std::string& fault) { show_warnings(std::cerr, {fault}); });
  RunResult run = play_and_autosave(slam, input, options, messages, interrupt);
  messages.finish(run);
  if (!options.quiet) show_warnings(std::cerr, run.warnings);
  if (const auto warning = calibration_warning(run.calibration, run.row_error)) show_warnings(std::cerr, {*warning});
  const ResourceUsage resources = resource_usage();
  input.note_frames(run, protocol);
  if (run.final.empty()) options.map.reset();  // nothing to save
  OutputWriter outputs;
  outputs.attempt([&] {
    const SlamInputs& inputs = slam.impl().inputs();
    if (options.map) save_for_missions_and_reload(run.stored, *inputs.vocabulary, inputs.site, *options.map);
  });
  Report report = run_report(run, protocol, resources);
  write_results(options, run, report, outputs);
  outputs.require_written();
  report.row("written", "{?files}{files}", {{"files", names_of(options.outputs())}});
  conclude(options, run, report);
  result << to_text(report, options.verbose) << input.report();
  if (interrupt.caught()) return ExitCode::interrupted;
  messages.require_written();
  require_frames(run);
  require_poses(run, protocol);
  return ExitCode::done;
}

void declare_map_options(CLI::App& command, MapOptions& options) {
  declare_files(command, options);
  declare_map_content(command, options);
  declare_building(command, options);
  declare_run_input(command, options);
  declare_run_output(command, options);
  check_when_parsed(command, [&options] { require_consistent(options); });
  command.footer(kMapFooter);
}

}  // namespace

Action declare_map(CLI::App& command) {
  const auto options = std::make_shared<MapOptions>();
  declare_map_options(command, *options);
  return [options](std::ostream& result) { return run_map_command(*options, result); };
}

}  // namespace byre::cli
