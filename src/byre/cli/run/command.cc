#include "byre/base/output_file.h"
#include "byre/cli/commands.h"
#include "byre/cli/shared/arguments.h"
#include "byre/cli/shared/options.h"
#include "byre/cli/shared/outputs.h"
#include "byre/cli/shared/progress.h"
#include "byre/cli/shared/run_input.h"
#include "byre/cli/shared/view_run.h"
#include "byre/features/image_threads.h"
#include "byre/floor_plan.h"
#include "byre/input_error.h"
#include "byre/io/image/plan_file.h"
#include "byre/io/recording/trajectory_input.h"
#include "byre/playback/play.h"
#include "byre/playback/report/event_log.h"
#include "byre/playback/report/mission_report.h"
#include "byre/playback/report/run_record.h"
#include "byre/playback/report/run_report.h"
#include "byre/site.h"
#include "byre/slam/system/option_table.h"
#include "byre/slam/system/stored_map.h"

#include <filesystem>
#include <iostream>
#include <memory>
#include <optional>
#include <sstream>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/core.h>

namespace byre::cli {
namespace {

namespace fs = std::filesystem;

// Options of "byre run".
struct RunOptions : RunInputOptions {
  std::optional<fs::path> map;  // offline map; empty: plain SLAM
  PoseFrame frame = PoseFrame::map;
  std::optional<fs::path> online_map;
  std::optional<fs::path> session;
  std::optional<fs::path> events;
  std::optional<fs::path> odometry;
  std::optional<fs::path> truth;
  std::optional<fs::path> map_truth;       // truth of the map's recording, if that is another one
  std::optional<fs::path> map_trajectory;  // trajectory of the run that made the map
  bool align_scale = false;                // aligns the map to the truth with scale, which a wrong baseline changes
  double time_offset_s = 0.0;              // added to the time stamps of truth and map truth
  ViewOptions view;

  std::vector<fs::path> outputs() const {
    return given_paths({online_map, session, events, trajectory, causal_trajectory, odometry, stats, record});
  }
};

constexpr const char* kRunFooter = R"(Examples:
  byre run evening_round --map barn.byre --events events.jsonl
  byre run evening_round --map barn.byre --trajectory map.txt --odometry odometry.txt --save-online changes.byre
  byre run evening_round --map barn.byre --save-session evening.session
  byre run evening_round --map farm.yaml --trajectory poses.txt --events events.jsonl
  byre run evening_round --map barn.byre --truth evening_round --map-truth morning_round --stats stats.json
  byre run evening_round --map barn.byre --localise-only --causal-trajectory causal.txt
  byre run evening_round --map barn.byre --camera left --events events.jsonl
  byre run evening_round --map barn-plan.byre --frame plan --trajectory plan.txt
  byre run evening_round --map barn.byre --pace live --view
  byre run evening.mcap --map barn.byre --left /front/left/image_raw --right /front/right/image_raw
  byre run evening_round --map barn.byre --record evening.mcap --record-images
  byre run evening_round --truth evening_round --stats without_map.json
  byre run --live /dev/video0 /dev/video2 --calibration camchain.yaml --map barn.byre --trajectory map.txt
  byre run --live /dev/video0 --side-by-side --calibration camchain.yaml --map barn.byre --exposure-limit 5 --view

With a map the run is a mission: it localises without an initial pose, tracks the offline map's points, maps new
points online, and gives each frame a verdict on its pose. The file of the offline map is only read. Poses are in the
map's frame; odometry is in a frame that begins at the start of the robot and never jumps. --localise-only disables
online mapping; --save-session keeps what "byre update" needs; --frame plan converts poses in the map to poses on the
floor plan of "byre register". On a site of several maps the robot begins on any of them. Each pose is in the frame of
the map active then, which events, statistics and TRAJECTORY.maps name. Saved files are of the last map
(docs/reference/site_file.md). Without --map the whole recording is mapped as by "byre map", including finishing. With
truth, errors are in the map's frame: the map, not the mission, is aligned to the truth by its own keyframes; for a
map of another recording also give the truth of that recording (--map-truth), and for a small map the trajectory of
the run that made it (--map-trajectory).
With --live the newest frame of the cameras is taken, at live pace unless --pace is given. The run lasts until
--duration or Ctrl-C; see docs/how-to/live_cameras.md.
With --view the run can be watched in a browser, and afterwards until Ctrl-C, or without a terminal for --view-for
seconds; see docs/how-to/watch_in_browser.md.
Ctrl-C or SIGTERM stops after the current frame and still writes all files, with exit code 130 or 143. Exit code 1 if
no frame got a pose, more than one frame in twenty could not be read, or events could not be written.
docs/reference/health_and_events.md describes events and health.)";

void declare_inputs(CLI::App& command, RunOptions& options) {
  declare_recording_argument(command, options);
  CLI::Option* const map = add_input(command, Input::file, "--map", options.map,
                                     "Offline map of the mission, or site file (none: plain SLAM)")
                               ->type_name("MAP|SITE");
  declare_method_flag(command, "--localise-only", "map_online", "false", options.method,
                      "Track the offline map only, without online mapping")
      ->needs(map);
  declare_pose_frame(command, options.frame)->needs(map);
  CLI::Option* const truth = add_input(command, Input::recording, "--truth", options.truth,
                                       "True poses of the frames: a trajectory or a recording with truth")
                                 ->type_name("FILE|FOLDER");
  add_input(command, Input::recording, "--map-truth", options.map_truth,
            "True poses of the map's recording in the same frame, to align the map (those of --truth)")
      ->type_name("FILE|FOLDER")
      ->needs(truth)
      ->needs(map);
  add_input(command, Input::recording, "--map-trajectory", options.map_trajectory,
            "Final poses of the run that made the map, all used to align it (default: the map's keyframes)")
      ->needs(truth)
      ->needs(map);
  command
      .add_flag("--align-scale", options.align_scale,
                "Align the map to the truth by a similarity, so that a scale error of the baseline does not count")
      ->needs(truth)
      ->needs(map);
  command.add_option("--time-offset", options.time_offset_s, "Added to the truth's time stamps (EuRoC MH_01: -0.0075)")
      ->type_name("SECONDS")
      ->check(between(-1e6, 1e6))
      ->needs(truth);
  declare_vocabulary_option(command, options.vocabulary);
}

void declare_outputs(CLI::App& command, RunOptions& options) {
  add_output(command, Output::map, "--save-online", options.online_map, "Online map of the mission, as a separate map");
  add_output(command, Output::map, "--save-session", options.session,
             "Session file: what the mission mapped, saw and missed, for \"byre update\"")
      ->type_name("SESSION")
      ->needs("--map");
  add_output(command, Output::json, "--events", options.events, "Events during the run, as JSON lines");
  add_output(command, Output::trajectory, "--trajectory", options.trajectory,
             "Final poses in the map's frame: as corrected after the last frame");
  add_output(command, Output::trajectory, "--causal-trajectory", options.causal_trajectory,
             "Causal poses in the map's frame: as published with their frames");
  add_output(command, Output::trajectory, "--odometry", options.odometry,
             "Odometry: poses without jumps, as published, in the odometry frame");
  add_output(command, Output::json, "--stats", options.stats,
             "Health, times, counts and the report of every frame, as JSON");
}

void require_consistent(const RunOptions& options) {
  require_consistent_input(options);
  if (options.live.is_wanted() && options.truth) {
    throw CLI::ValidationError("--truth",
                               "is for recordings: record the cameras (--record-images), then run on the record");
  }
  if (options.online_map && !options.method.options().session.map_online) {
    throw CLI::ValidationError("--localise-only", "disables online mapping, so --save-online has no map");
  }
  if (options.session && !options.method.options().session.map_online) {
    throw CLI::ValidationError("--localise-only", "disables online mapping, so --save-session has nothing to save");
  }
  if (options.map && is_site_file(*options.map)) {
    const bool is_of_one_map = options.truth || options.view.is_wanted || options.view.plan;
    if (is_of_one_map || options.frame == PoseFrame::plan) {
      throw CLI::ValidationError("--map", "is a site, and --truth, --frame plan, --plan and --view are of one map");
    }
  }
  if (options.view.plan && !options.map) {
    throw CLI::ValidationError("--plan", "needs a map that is registered on it: --map");
  }
}

Trajectory load_truth_later_by(const fs::path& path, Timestamp offset) {
  Trajectory truth = load_truth(path);
  for (StampedPose& sample : truth) sample.time += offset;
  return truth;
}

// Read before the run, so that errors appear early.
std::optional<MissionTruth> load_truths(const RunOptions& options) {
  if (!options.truth) return std::nullopt;
  const Timestamp offset = from_seconds(options.time_offset_s);
  MissionTruth truth;
  truth.frames = load_truth_later_by(*options.truth, offset);
  truth.map = options.map_truth ? load_truth_later_by(*options.map_truth, offset) : truth.frames;
  if (options.map_trajectory) truth.map_run = load_trajectory(*options.map_trajectory, {});
  if (options.align_scale) truth.map_scale = Scale::free;
  return truth;
}

// Warns of a plan whose walls cannot be used.
void check_walls(const DrawnFloorPlan& plan, const Slam& slam) {
  if (slam.impl().inputs().offline->walls() != nullptr) return;
  const bool are_known = plan.plan.occupied_threshold.has_value();
  show_warnings(std::cerr, {plan.plan.name + ": its walls are not used: " +
                            (are_known ? "a tenth of the map's path is inside them"
                                       : "it has no occupied_thresh, the threshold of walls")});
}

Slam make_slam(const RunOptions& options, const RunInput& input) {
  SlamOptions slam_settings = options.slam(input.name());
  if (!options.map) return Slam::mapping(input.calibration(), slam_settings);
  if (is_site_file(*options.map)) {
    return Slam::on_site(input.calibration(), read_site_with_plans(*options.map), slam_settings);
  }
  if (options.view.plan) slam_settings.plan = read_drawn_floor_plan(*options.view.plan);
  Slam slam = Slam::on_map(input.calibration(), *options.map, slam_settings);
  if (slam_settings.plan) check_walls(*slam_settings.plan, slam);
  return slam;
}

RunProtocol protocol_of(const RunOptions& options, const Slam& slam, const RunInput& input) {
  RunProtocol protocol;
  protocol.program = "byre run";
  input.describe(protocol);
  protocol.options = slam.impl().options();
  if (!options.map) return protocol;
  protocol.offline = options.map->string();
  if (options.frame == PoseFrame::plan) protocol.plan = require_plan(slam.impl().inputs().plan, *options.map);
  return protocol;
}

// Events are written after each frame, so that they survive any end of the program. A write failure is reported
// immediately, because another program may wait for events.
class EventFile {
 public:
  explicit EventFile(const std::optional<fs::path>& path) : path_(path) {
    if (!path_) return;
    file_.emplace(*path_, FileContent::json);
    file_->publish();
  }

  void note(int number, const PlayedFrame& frame) {
    if (!path_ || fault_) return;
    log_.note(number, frame);
    try {
      file_->append(text_.view());
      text_.str(std::string());
    } catch (const InputError& error) {
      fault_ = "events were not written: " + std::string(error.what());
      show_warnings(std::cerr, {*fault_});
    }
  }

  void require_written() const {
    if (fault_) throw std::runtime_error(*fault_);
  }

 private:
  std::optional<fs::path> path_;  // empty: disabled
  std::optional<OutputFile> file_;
  std::ostringstream text_;  // lines not yet written
  EventLog log_{text_};
  std::optional<std::string> fault_;
};

RunResult play_and_log(Slam& slam, RunInput& input, const RunProtocol& protocol, WatchedRunViewer* viewer,
                       EventFile& events, RunRecord& record, const InterruptCatcher& interrupt) {
  PlayHooks hooks;
  if (viewer != nullptr || record.is_wanted()) {
    hooks.on_frame = [&record, viewer](const RunView& view) {
      if (viewer != nullptr) viewer->note(view);
      record.note(view);
    };
  }
  hooks.after_frame = [&](int done, const PlayedFrame& frame) {
    events.note(done - 1, protocol.plan ? on_plan(frame, *protocol.plan) : frame);
    if (frame.report) return;
    record.note_unreadable(frame);
    if (viewer != nullptr) viewer->note_unreadable(frame);
  };
  return input.play(slam, hooks, interrupt);
}

// Times, in seconds, from which poses are in the frame of a map of a site: "TRAJECTORY.maps".
void write_maps(const fs::path& trajectory, const RunResult& run) {
  std::string text, map;
  for (const PlayedFrame& frame : run.frames) {
    if (!frame.report || frame.report->map == map) continue;
    map = frame.report->map;
    text += fmt::format("{:.9f} {}\n", to_seconds(frame.time), map);
  }
  if (!text.empty()) write_atomically(trajectory.string() + ".maps", text);
}

void write_results(const RunOptions& options, const RunResult& run, const Report& report, const MissionOutcome& mission,
                   OutputWriter& outputs) {
  outputs.attempt(options.trajectory, run.final, options.trajectory_format);
  outputs.attempt(options.causal_trajectory, run.causal, options.trajectory_format);
  outputs.attempt(options.odometry, run.odometry, options.trajectory_format);
  outputs.attempt([&] {
    for (const auto& trajectory : {options.trajectory, options.causal_trajectory}) {
      if (trajectory) write_maps(*trajectory, run);
    }
  });
  outputs.attempt([&] {
    if (options.stats) write_atomically(*options.stats, to_json(report, run, mission));
  });
}

void conclude(const RunOptions& options, const RunResult& run, const RunProtocol& protocol,
              const MissionOutcome& mission, Report& report) {
  if (run.final.empty()) return;    // an error follows
  constexpr double kMostly = 0.95;  // share of trusted frames
  if (!options.map) {
    report.conclude(
        "Tracked without a map. Next: byre map RECORDING -o MAP.byre, then byre run RECORDING --map MAP.byre");
    return;
  }
  nlohmann::ordered_json more = {{"is_mostly_trusted", report.figures["mission"]["trusted_share"] >= kMostly},
                                 {"map", options.map->string()},
                                 {"is_on_plan", protocol.plan.has_value() || is_site_file(*options.map)}};
  if (!mission.statistics.doubts.empty()) {
    const DistrustReason doubt = mission.statistics.doubts.front().first;
    more["doubt"] = to_string(doubt);
    more["advice"] = advice_for(doubt);
  }
  report.conclude(
      "{mission.trusted_share*100:.1f} % of the frames are trusted"
      "[{!is_mostly_trusted}, most others are not because: {doubt}[{?advice} ({advice})]]. Next: "
      "[{?is_on_plan}byre node robot.yaml, on the robot"
      "|byre register {map} --plan PLAN.yaml --points PICKS.csv -o MAP.byre, for poses on a floor plan]",
      more);
}

ExitCode run_mission(RunOptions options, std::ostream& result) {
  for (const fs::path& output : options.outputs()) require_writable(output);
  RunInput input(options, options.map.has_value());
  const std::optional<MissionTruth> truth = load_truths(options);
  Slam slam = make_slam(options, input);
  RunProtocol protocol = protocol_of(options, slam, input);

  limit_image_threads(1);
  input.show_check();
  std::optional<WatchedRunViewer> viewer;
  if (options.view.is_wanted) viewer.emplace(options.view, input.watched(options.map, slam.impl().inputs().offline));
  const InterruptCatcher interrupt;
  EventFile events(options.events);
  RunRecord record(std::optional<McapWriter>(options.record), input.calibration(), options.record_images,
                   [](const std::string& fault) { show_warnings(std::cerr, {fault}); });
  RunResult run = play_and_log(slam, input, protocol, viewer ? &*viewer : nullptr, events, record, interrupt);
  record.finish(run);
  if (viewer) viewer->finish(run);
  if (options.online_map && run.stored.map.keyframe_count() == 0) {
    run.warnings.push_back(options.online_map->string() + ": not written, as nothing was mapped");
    options.online_map.reset();
  }
  if (options.session && !slam.impl().has_mapped()) {
    run.warnings.push_back(options.session->string() + ": not written, as nothing was mapped");
    options.session.reset();
  }
  if (!options.quiet) show_warnings(std::cerr, run.warnings);
  OutputWriter outputs;
  outputs.attempt([&] {
    const SlamInputs& inputs = slam.impl().inputs();
    if (options.online_map) save_for_missions(run.stored, *inputs.vocabulary, inputs.site, *options.online_map);
  });
  outputs.attempt([&] {
    if (options.session) slam.save_session(*options.session);
  });
  const ResourceUsage resources = resource_usage();
  const MissionOutcome mission = evaluate_mission(run, protocol.options, truth, input.scaled());
  input.note_frames(run, protocol);
  if (protocol.plan) run = on_plan(std::move(run), *protocol.plan);
  Report report = run_report(run, protocol, resources, mission);
  write_results(options, run, report, mission, outputs);
  outputs.require_written();
  report.row("written", "{?files}{files}", {{"files", names_of(options.outputs())}});
  conclude(options, run, protocol, mission, report);
  result << to_text(report, options.verbose) << input.report();
  if (run.map_damage) throw InputError(*run.map_damage);
  if (interrupt.caught()) return ExitCode::interrupted;
  if (viewer) {
    result.flush();
    serve_after_run(options.view, interrupt, options.quiet);
  }
  events.require_written();
  record.require_written();
  require_frames(run);
  require_poses(run, protocol);
  return ExitCode::done;
}

void declare_run_options(CLI::App& command, RunOptions& options) {
  declare_inputs(command, options);
  declare_outputs(command, options);
  declare_run_input(command, options);
  declare_method_option(command, "--offline-weight", "tracking.offline_weight", options.method,
                        "Weight of an observation of an offline point; online points have 1");
  declare_run_viewer_options(command, options.view);
  declare_run_output(command, options);
  check_when_parsed(command, [&options] { require_consistent(options); });
  command.footer(kRunFooter);
}

}  // namespace

Action declare_run(CLI::App& command) {
  const auto options = std::make_shared<RunOptions>();
  declare_run_options(command, *options);
  return [options](std::ostream& result) { return run_mission(*options, result); };
}

}  // namespace byre::cli
