#pragma once

#include "byre/cli/shared/extrinsics_arguments.h"
#include "byre/cli/shared/method_arguments.h"
#include "byre/cli/shared/pose_options.h"
#include "byre/cli/shared/run_input.h"
#include "byre/cli/shared/view_options.h"
#include "byre/playback/play.h"
#include "byre/trajectory_file.h"

#include <filesystem>
#include <optional>
#include <vector>

namespace CLI {
class App;
}

namespace byre::cli {

// Options of "byre run".
struct RunOptions {
  std::filesystem::path recording;  // empty for live cameras
  LiveOptions live;
  std::optional<std::filesystem::path> map;  // offline map; empty: plain SLAM
  PoseFrame frame = PoseFrame::map;
  std::optional<std::filesystem::path> online_map;
  std::optional<std::filesystem::path> session;
  std::optional<std::filesystem::path> events;
  std::optional<std::filesystem::path> trajectory;
  std::optional<std::filesystem::path> causal_trajectory;
  std::optional<std::filesystem::path> odometry;
  std::optional<std::filesystem::path> stats;
  std::optional<std::filesystem::path> truth;
  std::optional<std::filesystem::path> map_truth;       // truth of the map's recording, if that is another one
  std::optional<std::filesystem::path> map_trajectory;  // trajectory of the run that made the map
  bool align_scale = false;    // aligns the map to the truth with scale, which a wrong baseline changes
  double time_offset_s = 0.0;  // added to the time stamps of truth and map truth
  std::optional<std::filesystem::path> vocabulary;  // empty: the vocabulary installed with byre
  FrameRange range;
  OpenOptions open;
  ExtrinsicsArguments extrinsics;
  MethodArguments method;
  ViewOptions view;
  TrajectoryFormat trajectory_format = TrajectoryFormat::tum;
  std::optional<std::filesystem::path> record;  // bag of ROS 2 messages
  bool record_images = false;
  bool quiet = false;
  bool verbose = false;

  std::vector<std::filesystem::path> outputs() const;
};

// The options must outlive the parsing of the command line.
void declare_run_options(CLI::App& command, RunOptions& options);

}  // namespace byre::cli
