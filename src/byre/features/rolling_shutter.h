#pragma once

#include "byre/features.h"

namespace byre {

// How a camera moved while it took an image, and how far away the scene is.
struct CameraMotion {
  Vector6 velocity = Vector6::Zero();  // per second: exp_pose(velocity * dt) * camera_from_world
  double depth = 1.0;                  // depth of corners that tell none themselves, in the velocity's unit of length
};

// A rolling shutter reads row after row, so that each corner is where the camera was at its row's time: the corners as
// all of them would be at the time of the middle row. readout_time in seconds, see Calibration.
Features seen_at_once(const Features& features, const Rig& rig, const CameraMotion& motion, double readout_time);
// The same; refills `result`.
void see_at_once(const Features& features, const Rig& rig, const CameraMotion& motion, double readout_time,
                 Features& result);

}  // namespace byre
