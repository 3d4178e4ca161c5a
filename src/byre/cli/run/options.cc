#include "byre/cli/run/options.h"

#include "byre/cli/shared/choice.h"
#include "byre/cli/shared/file_arguments.h"
#include "byre/cli/shared/number_check.h"
#include "byre/cli/shared/outputs.h"
#include "byre/cli/shared/pose_options.h"
#include "byre/cli/shared/record_options.h"
#include "byre/cli/shared/recording_options.h"

#include <string>

#include <CLI/CLI.hpp>
#include <fmt/core.h>

namespace byre::cli {
namespace {

namespace fs = std::filesystem;

constexpr const char* kRunFooter = R"(Examples:
  byre run evening_round --map barn.byre --events events.jsonl
  byre run evening_round --map barn.byre --trajectory map.txt --odometry odometry.txt --save-online changes.byre
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

With a map the run is a mission on it: it finds itself without a guess, tracks the map's points, maps what is new
beside them, and says of each frame how far its pose may be trusted. The map's file is only read. Poses are in the map's
frame, those of odometry in one that begins where the robot does and never jumps. With --localise-only nothing is mapped
beside the map; with --frame plan poses in the map become poses on the floor plan that "byre register" found it on.
Without --map all is mapped, as "byre map" does it, finishing included. With truth, errors are those in the map's
frame: the map alone, not the mission, is aligned to the truth by its own keyframes; for a map of another recording name
that one's truth too (--map-truth), and for a small map the trajectory of the run that made it (--map-trajectory).
With --live the newest frame of the cameras is taken, and --pace live holds unless told otherwise;
docs/how-to/live_cameras.md says more. The run goes on until --duration is over, or Ctrl-C.
With --view the run can be watched in a browser while it goes on, and afterwards until Ctrl-C, or without a terminal for
as long as --view-for says; docs/how-to/watch_in_browser.md says more.
Ctrl-C or SIGTERM stops after the current frame and still writes all files, then the exit code is 130 or 143. Exit code 1
when no frame got a pose, more than one frame in twenty could not be read, or events could not be written.
docs/reference/health_and_events.md describes the events and what health means.)";

void declare_inputs(CLI::App& command, RunOptions& options) {
  add_input(command, Input::recording, "RECORDING", options.recording, kRecordingHelp)->type_name("FOLDER|VIDEO|BAG");
  CLI::Option* const map =
      add_input(command, Input::file, "--map", options.map, "The offline map of the mission (none: plain SLAM)")
          ->type_name("MAP");
  command.add_flag("--localise-only", options.localise_only, "Track the offline map alone and map nothing beside it")
      ->needs(map);
  declare_pose_frame(command, options.frame)->needs(map);
  CLI::Option* const truth = add_input(command, Input::recording, "--truth", options.truth,
                                       "True poses of the frames: a trajectory or the recording that holds it")
                                 ->type_name("FILE|FOLDER");
  add_input(command, Input::recording, "--map-truth", options.map_truth,
            "True poses of the map's own recording in the same frame, to align the map by (that of --truth)")
      ->type_name("FILE|FOLDER")
      ->needs(truth)
      ->needs(map);
  add_input(command, Input::recording, "--map-trajectory", options.map_trajectory,
            "Final poses of the run that made the map, to align it by all of them (by the map's keyframes)")
      ->type_name("FILE")
      ->needs(truth)
      ->needs(map);
  command
      .add_flag("--align-scale", options.align_scale,
                "Lay the map on the truth by a similarity: a baseline that errs in length, which no image tells, does "
                "not count")
      ->needs(truth)
      ->needs(map);
  command.add_option("--time-offset", options.time_offset_s, "Added to the truth's time stamps (EuRoC MH_01: -0.0075)")
      ->type_name("SECONDS")
      ->check(between(-1e6, 1e6))
      ->needs(truth);
  add_input(command, Input::file, "--vocabulary", options.vocabulary,
            "Vocabulary to look places up with (the one byre comes with)")
      ->type_name("FILE");
}

void declare_outputs(CLI::App& command, RunOptions& options) {
  add_output(command, Output::map, "--save-online", options.online_map,
             "What was mapped beside the offline map, as a map of its own")
      ->type_name("MAP");
  add_output(command, Output::json, "--events", options.events, "What happens, as it happens: JSON lines")
      ->type_name("FILE");
  add_output(command, Output::trajectory, "--trajectory", options.trajectory,
             "Final poses in the map's frame: as recomputed after the last frame")
      ->type_name("FILE");
  add_output(command, Output::trajectory, "--causal-trajectory", options.causal_trajectory,
             "Causal poses in the map's frame: as published when their frames came")
      ->type_name("FILE");
  add_output(command, Output::trajectory, "--odometry", options.odometry,
             "Smooth poses, as published, in a frame of their own")
      ->type_name("FILE");
  add_output(command, Output::json, "--stats", options.stats, "Health, times, counts and every frame's report, as JSON")
      ->type_name("FILE");
}

void require_consistent(const RunOptions& options) {
  require_sense(options.range);
  require_one_input(options.recording, options.live, options.open);
  if (options.live.is_wanted() && options.truth) {
    throw CLI::ValidationError("--truth", "is of a recording: record the cameras (--record-images), then run on that");
  }
  if (options.localise_only && options.online_map) {
    throw CLI::ValidationError("--localise-only", "maps nothing, so there is nothing to --save-online");
  }
  if (options.view.plan && !options.map) {
    throw CLI::ValidationError("--plan", "lies under a map: name one that was found on it with --map");
  }
}

// Combination of points of both maps; the defaults were chosen by measurement.
void declare_tracking(CLI::App& command, RunOptions& options) {
  command
      .add_option("--offline-weight", options.offline_weight,
                  fmt::format("Weight of a measured offline point, against 1 of an online one ({:g})",
                              TrackOptions{}.offline_weight))
      ->type_name("FACTOR")
      ->check(between(1e-3, 1e3));
  add_choice(command, "--offline-policy", options.offline_policy, {OfflinePolicy::first, OfflinePolicy::together},
             "Offline points first, so that their pose guides the search for online ones, or both together (first)");
}

}  // namespace

std::vector<fs::path> RunOptions::outputs() const {
  return asked_for({online_map, events, trajectory, causal_trajectory, odometry, stats, record});
}

EngineOptions RunOptions::engine_options() const {
  EngineOptions engine = read_engine_options(options_file);
  if (live.is_wanted()) engine.pace = Pace::live;
  if (pace) engine.pace = *pace;
  if (offline_weight) engine.session.track.offline_weight = *offline_weight;
  if (offline_policy) engine.session.track.offline_policy = *offline_policy;
  if (localise_only) engine.session.map_online = false;
  return engine;
}

void declare_run_options(CLI::App& command, RunOptions& options) {
  declare_inputs(command, options);
  declare_outputs(command, options);
  declare_open_options(command, options.open);
  declare_frame_range(command, options.range);
  declare_live_options(command, options.live);
  declare_pace(command, options.pace);
  declare_tracking(command, options);
  declare_watching(command, options.view);
  declare_trajectory_format(command, options.trajectory_format);
  declare_recording(command, options.record, options.record_images);
  declare_options_file(command, options.options_file, [&options] { return options.engine_options(); });
  command.add_flag("--quiet", options.quiet, "Show no progress and no warnings");
  check_when_parsed(command, [&options] { require_consistent(options); });
  command.footer(kRunFooter);
}

}  // namespace byre::cli
