#pragma once

#include "byre/slam/window/initialisation.h"

#include <optional>
#include <vector>

namespace byre {

// Poses of the two cameras of a monocular start in an existing map, measured by wheels. The distance between them gives
// the scale of the start.
struct StartPoses {
  Pose first_camera_from_world;
  Pose second_camera_from_world;
};

// Adds the keyframes and points of a start to a map: the first camera at its measured pose, all lengths scaled by the
// measured motion. parent: of the first keyframe, from which the motion was measured. Returns the two keyframes; empty,
// and nothing is added, if the cameras turned or moved differently than measured.
std::vector<KeyframeId> add_monocular_submap(const MonocularStart& start, const StartPoses& odometry,
                                             const std::optional<KeyframeId>& parent, int recording, Map& map);

// Moves a first map so that its second camera is at its measured pose, with lengths scaled by the measured motion. The
// mounting of the wheels is unknown at that time, so the direction of the motion is not used. Lengths are kept if the
// camera turned so much that an unknown lever arm would change the length of its motion.
MonocularStart align_to_odometry(const MonocularStart& start, const StartPoses& odometry);

}  // namespace byre
