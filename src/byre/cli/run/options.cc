#include "byre/cli/run/options.h"

#include "byre/cli/shared/file_arguments.h"
#include "byre/cli/shared/number_check.h"
#include "byre/cli/shared/outputs.h"
#include "byre/cli/shared/pose_options.h"
#include "byre/cli/shared/record_options.h"
#include "byre/cli/shared/recording_options.h"
#include "byre/site.h"

#include <string>

#include <CLI/CLI.hpp>
#include <fmt/core.h>

namespace byre::cli {
namespace {

namespace fs = std::filesystem;

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
  add_input(command, Input::recording, "RECORDING", options.recording, kRecordingHelp)->type_name("FOLDER|VIDEO|BAG");
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
      ->type_name("FILE")
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
  add_input(command, Input::file, "--vocabulary", options.vocabulary,
            "Vocabulary for place recognition (the built-in one)")
      ->type_name("FILE");
}

void declare_outputs(CLI::App& command, RunOptions& options) {
  add_output(command, Output::map, "--save-online", options.online_map, "Online map of the mission, as a separate map")
      ->type_name("MAP");
  add_output(command, Output::map, "--save-session", options.session,
             "Session file: what the mission mapped, saw and missed, for \"byre update\"")
      ->type_name("SESSION")
      ->needs("--map");
  add_output(command, Output::json, "--events", options.events, "Events during the run, as JSON lines")
      ->type_name("FILE");
  add_output(command, Output::trajectory, "--trajectory", options.trajectory,
             "Final poses in the map's frame: as corrected after the last frame")
      ->type_name("FILE");
  add_output(command, Output::trajectory, "--causal-trajectory", options.causal_trajectory,
             "Causal poses in the map's frame: as published with their frames")
      ->type_name("FILE");
  add_output(command, Output::trajectory, "--odometry", options.odometry,
             "Odometry: poses without jumps, as published, in the odometry frame")
      ->type_name("FILE");
  add_output(command, Output::json, "--stats", options.stats,
             "Health, times, counts and the report of every frame, as JSON")
      ->type_name("FILE");
}

void require_consistent(const RunOptions& options) {
  require_valid(options.range);
  require_one_input(options.recording, options.live, options.open);
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

}  // namespace

std::vector<fs::path> RunOptions::outputs() const {
  return given_paths({online_map, session, events, trajectory, causal_trajectory, odometry, stats, record});
}

void declare_run_options(CLI::App& command, RunOptions& options) {
  declare_inputs(command, options);
  declare_outputs(command, options);
  declare_open_options(command, options.open);
  declare_extrinsics(command, options.extrinsics);
  declare_frame_range(command, options.range);
  declare_live_options(command, options.live, options.method);
  declare_pace(command, options.method);
  declare_method_option(command, "--offline-weight", "tracking.offline_weight", options.method,
                        "Weight of an observation of an offline point; online points have 1");
  declare_run_viewer_options(command, options.view);
  declare_trajectory_format(command, options.trajectory_format);
  declare_recording(command, options.record, options.record_images);
  declare_options_file(command, options.method);
  command.add_flag("--quiet", options.quiet, "Show no progress and no warnings");
  command.add_flag("--verbose", options.verbose, "Print figures for developers too: loops, inliers, times, memory");
  check_when_parsed(command, [&options] { require_consistent(options); });
  command.footer(kRunFooter);
}

}  // namespace byre::cli
