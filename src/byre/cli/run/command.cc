#include "byre/base/output_file.h"
#include "byre/cli/commands.h"
#include "byre/cli/run/options.h"
#include "byre/cli/shared/interrupt.h"
#include "byre/cli/shared/outputs.h"
#include "byre/cli/shared/run_input.h"
#include "byre/cli/shared/view_run.h"
#include "byre/cli/shared/warnings.h"
#include "byre/features/image_threads.h"
#include "byre/floor_plan.h"
#include "byre/input_error.h"
#include "byre/io/image/plan_file.h"
#include "byre/io/recording/trajectory_input.h"
#include "byre/playback/report/event_log.h"
#include "byre/playback/report/mission_evaluation.h"
#include "byre/playback/report/record_file.h"
#include "byre/playback/report/run_report.h"
#include "byre/playback/run_on_plan.h"
#include "byre/slam/system/option_table.h"
#include "byre/slam/system/stored_map.h"

#include <iostream>
#include <memory>
#include <sstream>
#include <stdexcept>
#include <utility>

#include <fmt/core.h>

namespace byre::cli {
namespace {

namespace fs = std::filesystem;

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
  SlamOptions slam_settings = slam_options(options.method.options());
  slam_settings.recording = input.name();
  slam_settings.vocabulary = options.vocabulary;
  slam_settings.baseline = options.open.baseline;
  slam_settings.extrinsics = options.extrinsics.read(options.open);
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
                       EventFile& events, RecordFile& record, const InterruptCatcher& interrupt) {
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
  RunInput input(
      {options.recording, options.range, options.open, options.live, options.map.has_value(), options.quiet});
  const std::optional<MissionTruth> truth = load_truths(options);
  Slam slam = make_slam(options, input);
  RunProtocol protocol = protocol_of(options, slam, input);

  limit_image_threads(1);
  input.show_check();
  std::optional<WatchedRunViewer> viewer;
  if (options.view.is_wanted) viewer.emplace(options.view, input.watched(options.map, slam.impl().inputs().offline));
  const InterruptCatcher interrupt;
  EventFile events(options.events);
  RecordFile record(std::optional<McapWriter>(options.record), input.calibration(), options.record_images,
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

}  // namespace

Action declare_run(CLI::App& command) {
  const auto options = std::make_shared<RunOptions>();
  declare_run_options(command, *options);
  return [options](std::ostream& result) { return run_mission(*options, result); };
}

}  // namespace byre::cli
