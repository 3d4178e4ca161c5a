#pragma once

#include "byre/image.h"
#include "byre/slam/system/slam_impl.h"

#include <functional>
#include <optional>
#include <vector>

namespace byre {

// Frames of a run, to be read a second time.
struct FramesAgain {
  std::vector<Timestamp> times;                              // times of all frames, ascending
  std::function<std::optional<ImageFrame>(int index)> read;  // empty: not usable
  std::function<bool()> should_stop;                         // polled before each frame
};

// Locates frames in the finished map that were tracked by another calibration, each from its pose. Returns the poses
// found; `located` if stopped.
Trajectory located_again(SlamImpl& slam, const Trajectory& located, const FramesAgain& frames);

// Locates frames without a pose in the finished map: those before the map begins, and those of gaps. Each gap is
// searched from both of its sides, frame by frame from the last located one. With one camera and without odometry,
// frames that are still missing are then localised without a prediction. Returns `located` with the poses found.
Trajectory with_missing_poses(SlamImpl& slam, const Trajectory& located, const FramesAgain& frames);

}  // namespace byre
