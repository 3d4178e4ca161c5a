#pragma once

#include "byre/cli/shared/extrinsics_arguments.h"
#include "byre/cli/shared/method_arguments.h"
#include "byre/cli/shared/run_input.h"
#include "byre/playback/play.h"
#include "byre/trajectory_file.h"

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace CLI {
class App;
}

namespace byre::cli {

// Options of "byre map".
struct MapOptions {
  std::filesystem::path recording;  // empty for live cameras
  LiveOptions live;
  std::optional<std::filesystem::path> map;
  std::optional<std::filesystem::path> trajectory;
  std::optional<std::filesystem::path> causal_trajectory;
  std::optional<std::filesystem::path> stats;
  std::optional<std::filesystem::path> given_poses;  // given trajectory of the recording; empty: it is estimated
  std::optional<std::filesystem::path> vocabulary;   // empty: the vocabulary installed with byre
  std::optional<std::filesystem::path> extended;     // map to extend
  std::optional<std::filesystem::path> tags;         // file of AprilTags
  std::optional<double> autosave_s;
  std::string site;
  FrameRange range;
  OpenOptions open;
  ExtrinsicsArguments extrinsics;
  MethodArguments method;
  TrajectoryFormat trajectory_format = TrajectoryFormat::tum;
  std::optional<std::filesystem::path> record;  // bag of ROS 2 messages
  bool record_images = false;
  bool quiet = false;
  bool verbose = false;

  std::vector<std::filesystem::path> outputs() const;
};

// The options must outlive the parsing of the command line.
void declare_map_options(CLI::App& command, MapOptions& options);

}  // namespace byre::cli
