#pragma once

#include "byre/features/extract.h"
#include "byre/recording.h"
#include "byre/slam/window/map_from_poses.h"

#include <functional>
#include <string>
#include <vector>

namespace byre {

// Map made from a recording with given poses.
struct PosedRun {
  MapGraph map{Origin::offline};
  Trajectory trajectory;  // given poses of the keyframes
  int frames = 0;         // frames processed
  int without_pose = 0;   // frames skipped as the trajectory does not cover their time
  int unreadable = 0;     // frames skipped as their images are unreadable
  std::vector<std::string> warnings;
};

struct PosedRunHooks {
  std::function<bool()> should_stop;  // called before each frame
  std::function<void(int done)> after_frame;
};

// Turns each frame with a pose into a keyframe; the world frame is that of the trajectory. Throws InputError if the
// calibration cannot be rectified, or no frame has a pose.
PosedRun run_map_from_poses(Recording& recording, const Trajectory& world_from_body, const ExtractOptions& extract,
                            const PosedRunHooks& hooks);

}  // namespace byre
