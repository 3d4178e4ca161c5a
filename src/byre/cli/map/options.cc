#include "byre/cli/map/options.h"

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
  add_input(command, Input::recording, "RECORDING", options.recording, kRecordingHelp)->type_name("FOLDER|VIDEO|BAG");
  add_output(command, Output::map, "-o,--output", options.map,
             "Map, for \"byre localise\", \"byre inspect\" and later missions")
      ->type_name("MAP");
  add_output(command, Output::trajectory, "--trajectory", options.trajectory,
             "Final poses: as corrected after the last frame")
      ->type_name("FILE");
  add_output(command, Output::trajectory, "--causal-trajectory", options.causal_trajectory,
             "Causal poses: as published with their frames")
      ->type_name("FILE");
  add_output(command, Output::json, "--stats", options.stats, "Times, counts and the report of every frame, as JSON")
      ->type_name("FILE");
}

void declare_map_content(CLI::App& command, MapOptions& options) {
  add_input(command, Input::recording, "--poses", options.given_poses,
            "Trajectory of given body poses, which are held fixed; every frame becomes a keyframe")
      ->type_name("FILE");
  add_input(command, Input::file, "--tags", options.tags,
            "AprilTags on the robot's way, for missions: YAML, see docs/how-to/use_apriltags.md")
      ->type_name("FILE");
  add_text(command, "--site", options.site, "Name of the building, stored in the map")->type_name("TEXT");
  add_input(command, Input::file, "--vocabulary", options.vocabulary,
            "Vocabulary of the map's words (the built-in one)")
      ->type_name("FILE");
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
  require_valid(options.range);
  require_one_input(options.recording, options.live, options.open);
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

}  // namespace

std::vector<fs::path> MapOptions::outputs() const {
  return given_paths({map, trajectory, causal_trajectory, stats, record});
}

void declare_map_options(CLI::App& command, MapOptions& options) {
  declare_files(command, options);
  declare_map_content(command, options);
  declare_building(command, options);
  declare_open_options(command, options.open);
  declare_extrinsics(command, options.extrinsics);
  declare_frame_range(command, options.range);
  declare_live_options(command, options.live, options.method);
  declare_pace(command, options.method);
  declare_trajectory_format(command, options.trajectory_format);
  declare_recording(command, options.record, options.record_images);
  declare_options_file(command, options.method);
  command.add_flag("--quiet", options.quiet, "Show no progress and no warnings");
  command.add_flag("--verbose", options.verbose, "Print figures for developers too: loops, inliers, times, memory");
  check_when_parsed(command, [&options] { require_consistent(options); });
  command.footer(kMapFooter);
}

}  // namespace byre::cli
