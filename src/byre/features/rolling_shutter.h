#pragma once

#include "byre/features.h"

namespace byre {

// Velocity of a camera during one image, and depth of the scene.
struct CameraMotion {
  Vector6 velocity = Vector6::Zero();  // per second: exp_pose(velocity * dt) * camera_from_world
  double depth = 1.0;                  // default for corners without disparity, in the velocity's unit of length
};

// Rolling-shutter correction: moves each corner, seen at the time of its row, to its position at the time of the middle
// row. readout_time: seconds, see Calibration.
Features correct_rolling_shutter(const Features& features, const Rig& rig, const CameraMotion& motion,
                                 double readout_time);
// Same, refills `result`.
void correct_rolling_shutter(const Features& features, const Rig& rig, const CameraMotion& motion, double readout_time,
                             Features& result);

}  // namespace byre
