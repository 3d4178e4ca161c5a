#pragma once

#include "byre/cli/shared/method_arguments.h"
#include "byre/map/plan/occupancy_grid.h"
#include "byre/recording.h"
#include "byre/viewer/plan_picture.h"

#include <filesystem>
#include <optional>
#include <vector>

namespace CLI {
class App;
}

namespace byre::cli {

// Options of "byre draw".
struct DrawOptions {
  std::filesystem::path input;               // a map, or a recording to run
  std::optional<std::filesystem::path> map;  // map for running a recording
  std::optional<std::filesystem::path> plan;
  std::vector<std::filesystem::path> trajectories;
  std::vector<std::filesystem::path> missions;  // statistics of "byre run"
  std::optional<std::filesystem::path> plan_picture;
  std::optional<std::filesystem::path> camera_picture;
  std::optional<std::filesystem::path> video;
  std::optional<std::filesystem::path> grid;  // .pgm, with a .yaml file next to it
  GridOptions grid_options;
  std::optional<double> at_s;  // time of the camera picture in the recording, seconds; empty: the last frame
  double speed = 1.0;          // playback speed of the video
  int width = 1200;            // pixels, of the plan picture
  HeightBand heights;
  std::optional<std::filesystem::path> vocabulary;  // empty: the vocabulary installed with byre
  FrameRange range;
  OpenOptions open;
  MethodArguments method;  // for running the recording
  bool quiet = false;

  const std::filesystem::path& map_file() const { return map ? *map : input; }
  std::vector<std::filesystem::path> outputs() const;
};

// The options must outlive the parsing of the command line.
void declare_draw_options(CLI::App& command, DrawOptions& options);

}  // namespace byre::cli
