#pragma once

#include "byre/cli/shared/options_file.h"
#include "byre/cli/shared/pose_options.h"
#include "byre/cli/shared/run_input.h"
#include "byre/cli/shared/view_options.h"
#include "byre/playback/map_run.h"
#include "byre/trajectory_file.h"

#include <filesystem>
#include <optional>
#include <vector>

namespace CLI {
class App;
}

namespace byre::cli {

// The command line of "byre run".
struct RunOptions {
  std::filesystem::path recording;  // empty where cameras are live
  LiveOptions live;
  std::optional<std::filesystem::path> map;  // the offline map; without it plain SLAM
  bool localise_only = false;
  PoseFrame frame = PoseFrame::map;
  std::optional<std::filesystem::path> online_map;
  std::optional<std::filesystem::path> events;
  std::optional<std::filesystem::path> trajectory;
  std::optional<std::filesystem::path> causal_trajectory;
  std::optional<std::filesystem::path> odometry;
  std::optional<std::filesystem::path> stats;
  std::optional<std::filesystem::path> truth;
  std::optional<std::filesystem::path> map_truth;       // truth of the map's own recording, where that is another
  std::optional<std::filesystem::path> map_trajectory;  // trajectory of the run that made the map
  bool align_scale = false;    // the map is laid on the truth with its scale, which an erring baseline changes
  double time_offset_s = 0.0;  // added to the time stamps of truth and map truth
  std::optional<std::filesystem::path> vocabulary;  // empty: the vocabulary that comes with byre
  FrameRange range;
  OpenOptions open;  // how to take the recording
  OptionsFile options_file;
  std::optional<Pace> pace;
  std::optional<double> offline_weight;
  std::optional<OfflinePolicy> offline_policy;
  ViewOptions view;
  TrajectoryFormat trajectory_format = TrajectoryFormat::tum;
  std::optional<std::filesystem::path> record;  // what happens, as messages of ROS 2
  bool record_images = false;
  bool quiet = false;

  std::vector<std::filesystem::path> outputs() const;  // outputs that were asked for
  EngineOptions engine_options() const;                // options by the file and the command line; not the maps
};

// The options must outlive the parsing of the command line.
void declare_run_options(CLI::App& command, RunOptions& options);

}  // namespace byre::cli
