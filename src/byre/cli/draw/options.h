#pragma once

#include "byre/cli/shared/options_file.h"
#include "byre/recording.h"
#include "byre/viewer/plan_picture.h"

#include <filesystem>
#include <optional>
#include <vector>

namespace CLI {
class App;
}

namespace byre::cli {

// The command line of "byre draw".
struct DrawOptions {
  std::filesystem::path input;               // a map; or a recording, to be run
  std::optional<std::filesystem::path> map;  // on this one
  std::optional<std::filesystem::path> plan;
  std::vector<std::filesystem::path> trajectories;
  std::vector<std::filesystem::path> missions;  // statistics of "byre run"
  std::optional<std::filesystem::path> plan_picture;
  std::optional<std::filesystem::path> camera_picture;
  std::optional<std::filesystem::path> video;
  std::optional<double> at_s;  // seconds into the recording of the camera picture; empty: the last frame
  double speed = 1.0;          // speed of the video over that of the recording
  int width = 1200;            // pixels, width of the plan picture
  HeightBand heights;
  std::optional<std::filesystem::path> vocabulary;  // empty: the vocabulary that comes with byre
  FrameRange range;
  OpenOptions open;
  OptionsFile options_file;  // for running the recording
  bool quiet = false;

  const std::filesystem::path& map_file() const { return map ? *map : input; }
  std::vector<std::filesystem::path> outputs() const;  // outputs that were asked for
};

// The options must outlive the parsing of the command line.
void declare_draw_options(CLI::App& command, DrawOptions& options);

}  // namespace byre::cli
