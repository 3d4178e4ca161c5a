#include "byre/cli/map/options.h"

#include "byre/cli/shared/choice.h"
#include "byre/cli/shared/file_arguments.h"
#include "byre/cli/shared/number_check.h"
#include "byre/cli/shared/outputs.h"
#include "byre/cli/shared/pose_options.h"
#include "byre/cli/shared/record_options.h"
#include "byre/cli/shared/recording_options.h"

#include <string>

#include <CLI/CLI.hpp>

namespace byre::cli {
namespace {

namespace fs = std::filesystem;

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
  byre map --live /dev/video0 /dev/video2 --calibration camchain.yaml -o barn.byre --duration 120

inline runs mapping between the frames, paced beside them with the same result each time; both as fast as they can.
live feeds the frames at their own time stamps, none is dropped; of cameras (--live) it takes the newest one. Trajectories are of the body: EuRoC's is the IMU,
KITTI's the left camera. After the last frame loops are looked for once more, all of the map is adjusted, and weak
points and redundant keyframes are removed. With --extend that is done to what came and to what lies around it; "byre
refine" does it to all of the map. Ctrl-C or SIGTERM stops after the current frame, leaves this out and still
writes all files, then the exit code is 130 or 143; "byre refine" makes up for it. A second one ends the program at once.)";

void declare_files(CLI::App& command, MapOptions& options) {
  add_input(command, Input::recording, "RECORDING", options.recording, kRecordingHelp)->type_name("FOLDER|VIDEO|BAG");
  add_output(command, Output::map, "-o,--output", options.map,
             "The map, for \"byre localise\", \"byre inspect\" and later missions")
      ->type_name("MAP");
  add_output(command, Output::trajectory, "--trajectory", options.trajectory,
             "Final poses: as recomputed after the last frame")
      ->type_name("FILE");
  add_output(command, Output::trajectory, "--causal-trajectory", options.causal_trajectory,
             "Causal poses: as published when their frames came")
      ->type_name("FILE");
  add_output(command, Output::json, "--stats", options.stats, "Times, counts and every frame's report, as JSON")
      ->type_name("FILE");
}

void declare_map_content(CLI::App& command, MapOptions& options) {
  add_input(command, Input::recording, "--poses", options.given_poses,
            "Take the body's poses from this trajectory and hold them fixed: every frame becomes a keyframe")
      ->type_name("FILE");
  add_text(command, "--site", options.site, "Name of the building, kept in the map")->type_name("TEXT");
  add_input(command, Input::file, "--vocabulary", options.vocabulary,
            "Vocabulary of the map's words (the one that comes with byre)")
      ->type_name("FILE");
}

void declare_building(CLI::App& command, MapOptions& options) {
  add_input(command, Input::file, "--extend", options.extended,
            "Go on with this map: the recording is found in it, and adjusted with what lies around")
      ->type_name("MAP");
  command
      .add_option("--autosave", options.autosave_s, "Also save the map so far, each time so many seconds have passed")
      ->type_name("SECONDS")
      ->check(between(0.1, 1e6));
  command.add_flag("--no-loops", options.no_loops,
                   "Recognise no places and leave out what comes after the last frame; for comparison");
  command.add_flag("--no-self-calibration", options.no_self_calibration,
                   "Take the calibration as it is given, instead of refining it from what is seen");
}

void require_consistent_extension(const MapOptions& options) {
  if (!options.extended) return;
  if (!options.map) throw CLI::ValidationError("--extend", "makes a new map: name a file for it (-o barn2.byre)");
  if (options.no_loops)
    throw CLI::ValidationError("--extend", "has to recognise places, so it goes not with --no-loops");
}

void require_consistent(const MapOptions& options) {
  require_sense(options.range);
  require_one_input(options.recording, options.live, options.open);
  if (options.live.is_wanted() && options.given_poses) {
    throw CLI::ValidationError("--poses", "are those of a recording, so they go not with --live");
  }
  if (!options.map && !options.trajectory) {
    throw CLI::ValidationError("--output",
                               "name a file for the map (-o barn.byre), the trajectory (--trajectory), or both");
  }
  if (options.given_poses && !options.map) {
    throw CLI::ValidationError("--poses", "makes a map only: name a file for it (-o barn.byre)");
  }
  if (options.given_poses && (options.trajectory || options.causal_trajectory || options.stats || options.record)) {
    throw CLI::ValidationError("--poses",
                               "estimates no trajectory, so none can be written, nor statistics or a record");
  }
  if (options.given_poses && (options.extended || options.autosave_s || options.no_loops)) {
    throw CLI::ValidationError("--poses", "goes with none of --extend, --autosave and --no-loops");
  }
  if (options.autosave_s && !options.map) {
    throw CLI::ValidationError("--autosave", "saves the map: name a file for it (-o barn.byre)");
  }
  require_consistent_extension(options);
}

}  // namespace

std::vector<fs::path> MapOptions::outputs() const {
  return asked_for({map, trajectory, causal_trajectory, stats, record});
}

EngineOptions MapOptions::engine_options() const {
  EngineOptions engine = read_engine_options(options_file);
  if (live.is_wanted()) engine.pace = Pace::live;
  if (pace) engine.pace = *pace;
  if (refinement) engine.extract.refinement = *refinement;
  if (no_self_calibration) engine.self_calibrate = false;
  return engine;
}

void declare_map_options(CLI::App& command, MapOptions& options) {
  declare_files(command, options);
  declare_map_content(command, options);
  declare_building(command, options);
  declare_open_options(command, options.open);
  declare_frame_range(command, options.range);
  declare_live_options(command, options.live);
  declare_pace(command, options.pace);
  add_choice(command, "--refine", options.refinement, {Refinement::none, Refinement::stereo, Refinement::all},
             "Matches refined in the image; less than all is for comparison (all)");
  declare_trajectory_format(command, options.trajectory_format);
  declare_recording(command, options.record, options.record_images);
  declare_options_file(command, options.options_file, [&options] { return options.engine_options(); });
  command.add_flag("--quiet", options.quiet, "Show no progress and no warnings");
  check_when_parsed(command, [&options] { require_consistent(options); });
  command.footer(kMapFooter);
}

}  // namespace byre::cli
