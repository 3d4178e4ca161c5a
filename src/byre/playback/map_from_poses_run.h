#pragma once

#include "byre/features/extract.h"
#include "byre/recording.h"
#include "byre/slam/map_from_poses.h"

#include <functional>
#include <string>
#include <vector>

namespace byre {

struct PosedRunOptions {
  ExtractOptions extract;
  KnownPoseOptions map;
  Timestamp max_gap = std::chrono::milliseconds(100);  // between two poses that one may be interpolated in
};

// A map made from a recording and the poses of its frames.
struct PosedRun {
  Map map{Origin::offline};
  Trajectory trajectory;  // given poses of the frames that are in the map
  int frames = 0;         // frames looked at
  int without_pose = 0;   // frames left out because the trajectory says nothing of their time
  int unreadable = 0;     // frames left out because their images cannot be read
  std::vector<std::string> warnings;
};

struct PosedRunHooks {
  std::function<bool()> should_stop;  // asked before each frame
  std::function<void(int done)> after_frame;
};

// Every frame of the recording with a pose becomes a keyframe; the world is the trajectory's. Throws InputError when
// the calibration cannot be rectified, and when no frame has a pose.
PosedRun run_map_from_poses(Recording& recording, const Trajectory& world_from_body, const PosedRunOptions& options,
                            const PosedRunHooks& hooks);

}  // namespace byre
