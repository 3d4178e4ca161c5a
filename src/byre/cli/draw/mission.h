#pragma once

#include "byre/cli/shared/options.h"
#include "byre/map/plan/occupancy_grid.h"
#include "byre/viewer/plan_picture.h"
#include "byre/viewer/scene.h"

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

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

// Data for pictures of a mission.
struct DrawnMission {
  PlanPath path;                    // poses as published, with verdicts
  std::optional<FrameScene> frame;  // empty if no frame was readable up to that time
  std::optional<double> frame_s;    // time of the frame since the start of the recording, seconds
  std::optional<Rig> rig;           // rig of the frame
  int video_frames = 0;
  bool plays_in_browsers = false;  // whether browsers can play the video
  MapScene online;                 // online map
  std::vector<std::string> warnings;
  bool stopped = false;  // whether Ctrl-C stopped it
};

// Runs the recording on the map, and writes the video. background: scene without the mission. Throws InputError as
// opening the recording and the map do, and for a time outside the range.
DrawnMission draw_mission(const DrawOptions& options, const PlanScene& background);

}  // namespace byre::cli
