#pragma once

#include "byre/rig.h"
#include "byre/trajectory.h"

namespace byre {

// Smooth trajectories about the centre of a room, the world's origin; the world's z points up. Always it is the camera
// that looks along the path, level, with its x axis to the right; body_from_camera says where the body is: with the
// identity the body is the camera.

// A stereo camera as large as EuRoC's: 752 x 480 pixels, 82 degrees wide, baseline 0.11 m.
Rig simulated_rig(const Pose& body_from_camera = {});

// A camera on a robot whose body has x forward, y left, z up: it looks forward, ahead of and above the body's origin.
Pose robot_from_camera();

// Counter-clockwise, at constant height, looking along the circle; whole laps end where they began.
Trajectory circling_trajectory(int frames, double frame_rate_hz, double radius_m, double laps,
                               const Pose& body_from_camera = {});

// The camera stays at the room's centre and turns to the left.
Trajectory turning_in_place_trajectory(int frames, double frame_rate_hz, double turns,
                                       const Pose& body_from_camera = {});

// A figure of eight, length_m long and half as wide, that rises and falls and leans into its bends, so that all six
// degrees of freedom are moved.
Trajectory figure_eight_trajectory(int frames, double frame_rate_hz, double length_m, double laps,
                                   const Pose& body_from_camera = {});

}  // namespace byre
